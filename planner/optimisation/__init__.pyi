from .corridor import Tolerance as Tolerance, deviation as deviation
from .optimise import (
    FLOW_SAMPLES as FLOW_SAMPLES,
    Criterion as Criterion,
    Objective as Objective,
    Optimiser as Optimiser,
)
from .solver import (
    Expression as Expression,
    MissingSolverError as MissingSolverError,
    casadi_function as casadi_function,
)
from .stages import Stage as Stage, cycle as cycle
from .task import (
    CHEAP as CHEAP,
    Inequality as Inequality,
    Solution as Solution,
    Task as Task,
)
