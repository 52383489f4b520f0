from .execution import (
    Coordinates as Coordinates,
    Execution as Execution,
    StanceRule as StanceRule,
)
from .stepping import (
    StabilityTest as StabilityTest,
    reposition_legs as reposition_legs,
    stepped as stepped,
)
