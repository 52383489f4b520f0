"""The commands of `stratawalk`, one module each.

Each module has `HELP`, `OPTIONS` and `execute(options)`. Slow imports take place when
the command is executed.
"""
