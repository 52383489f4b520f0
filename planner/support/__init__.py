"""A second door beside `planner`, for programs that plan rather than for mathematics.

Files that are written whole, searches that end in time or at Ctrl-C, and the words in
which a message names a place or a name that is unknown. `models` and `sim` import these
from here.
"""

from planner.errors import (
    did_you_mean as did_you_mean,
    installing as installing,
    point as point,
    require_known as require_known,
    sentences as sentences,
    shipped_tables as shipped_tables,
    unknown as unknown,
)
from planner.support.files import (
    open_file as open_file,
    placed as placed,
    read_file as read_file,
    read_text as read_text,
    remove_unfinished as remove_unfinished,
    require_space as require_space,
    unfinished as unfinished,
    whole_file as whole_file,
)
from planner.support.stopping import (
    best_so_far as best_so_far,
    forget_interruption as forget_interruption,
    limited as limited,
    note_interruption as note_interruption,
    tick as tick,
    unanswered_interruption as unanswered_interruption,
    unlimited as unlimited,
)
