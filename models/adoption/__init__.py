"""Cards drafted for robots that nobody described yet: legs, groups, posture, servos."""
