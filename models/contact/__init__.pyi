from .kinematics import (
    UPRIGHT as UPRIGHT,
    Lifting as Lifting,
    Stance as Stance,
)
from .loads import static_loads as static_loads
from .soles import (
    covering_core as covering_core,
    find_sole as find_sole,
)
