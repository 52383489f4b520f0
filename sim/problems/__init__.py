"""Planning problems, a scenario's or a system's, and the one way to solve them."""
