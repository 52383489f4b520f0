"""Short experiments: a robot's fields as measured, and the solver's creep."""
