from .execution import (
    Coordinates as Coordinates,
    Execution as Execution,
    StanceRule as StanceRule,
)
from .repositioning import reposition_legs as reposition_legs
from .stepping import (
    StabilityTest as StabilityTest,
    stepped as stepped,
)
