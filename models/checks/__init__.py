"""Whether a file and its card make a robot that can walk."""
