"""Short experiments that measure a robot's fields and the creep of its feet."""
