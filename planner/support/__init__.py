"""A second door beside `planner`, for programs that plan rather than for mathematics.

Files that are written whole, searches that end in time or at Ctrl-C, and the words in
which a message names a place or a name that is unknown. `models` and `sim` import these
from here.
"""

from planner.errors import did_you_mean, point, unknown
from planner.support.files import (
    open_file,
    read_file,
    remove_unfinished,
    require_space,
    whole_file,
)
from planner.support.stopping import (
    best_so_far,
    forget_interruption,
    limited,
    note_interruption,
    tick,
    unanswered_interruption,
    unlimited,
)

__all__ = [
    "best_so_far",
    "did_you_mean",
    "forget_interruption",
    "limited",
    "note_interruption",
    "open_file",
    "point",
    "read_file",
    "remove_unfinished",
    "require_space",
    "tick",
    "unanswered_interruption",
    "unknown",
    "unlimited",
    "whole_file",
]
