from .closure import LieClosure as LieClosure, involutive_closure as involutive_closure
from .examples import EXAMPLES as EXAMPLES
from .fields import (
    NumericField as NumericField,
    VectorField as VectorField,
    bracket as bracket,
)
from .flows import (
    Flow as Flow,
    Gait as Gait,
    contact_switches as contact_switches,
    flow_map as flow_map,
    gait_steps as gait_steps,
    merged as merged,
    merged_segments as merged_segments,
)
from .formulas import (
    MOST_NAMES as MOST_NAMES,
    RESERVED as RESERVED,
    read_formula as read_formula,
)
from .grouping import regroup as regroup
from .level_sets import LevelSet as LevelSet
from .shape import ShapeCoordinates as ShapeCoordinates, ShapeLimits as ShapeLimits
from .strata import StratifiedSystem as StratifiedSystem
