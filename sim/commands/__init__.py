"""The commands of `stratawalk`: functions, whose modules are loaded as one executes."""
