"""The commands of `stratawalk`, one module each.

A module has `HELP`, `add_arguments(parser)` and `execute(options)`, and imports what
is slow to import only when it executes.
"""
