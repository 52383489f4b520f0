"""Where a walking robot is, as its sensors tell, and what its segments miss."""
