"""The commands of `stratawalk`, one module each.

Each module has `HELP`, `add_arguments(parser)` and `execute(options)`. Slow imports
take place when the command is executed.
"""
