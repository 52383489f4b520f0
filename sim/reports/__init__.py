"""Pages about finished runs, drawn from their run folders alone.

`report.html` tells of one run, the page of `stratawalk compare` of several.
"""
