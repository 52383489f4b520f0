"""The commands of `stratawalk`, each a function that `options.command` declares.

Slow imports take place when a command is executed.
"""
