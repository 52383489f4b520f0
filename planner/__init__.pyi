from .controllability import (
    Controllability as Controllability,
    gait_controllability as gait_controllability,
)
from .errors import (
    BoundError as BoundError,
    BudgetError as BudgetError,
    ConvergenceError as ConvergenceError,
    DecouplingError as DecouplingError,
    PlannerError as PlannerError,
    RangeError as RangeError,
    RankError as RankError,
    ResolutionError as ResolutionError,
    SingularConfigurationError as SingularConfigurationError,
    StratumError as StratumError,
)
from .execution import Execution as Execution
from .extension import (
    ExtendedSystem as ExtendedSystem,
    Steering as Steering,
    choose_elements as choose_elements,
    extend as extend,
    hall_fields as hall_fields,
    on_bottom as on_bottom,
    require_decoupled as require_decoupled,
    stratified_panels as stratified_panels,
    tangent_field as tangent_field,
)
from .lie import (
    LieAlgebra as LieAlgebra,
    adjoint_action as adjoint_action,
    backward as backward,
    backward_from_forward as backward_from_forward,
    backward_matrix as backward_matrix,
    coordinate_rates as coordinate_rates,
    degree as degree,
    forward as forward,
    hall_basis as hall_basis,
    integrate as integrate,
    logarithm as logarithm,
    word as word,
)
from .numerics.arrays import Array as Array
from .planning import (
    Path as Path,
    Plan as Plan,
    aim as aim,
    convergence_order as convergence_order,
    critical_step as critical_step,
    ellipse as ellipse,
    least_critical_step as least_critical_step,
    line as line,
    load_plan as load_plan,
    plan as plan,
    play as play,
    rollout as rollout,
    save_plan as save_plan,
    steer as steer,
    subdivide as subdivide,
    waypoints as waypoints,
)
from .systems import (
    Flow as Flow,
    Gait as Gait,
    LevelSet as LevelSet,
    NumericField as NumericField,
    StratifiedSystem as StratifiedSystem,
    bracket as bracket,
    contact_switches as contact_switches,
    flow_map as flow_map,
)
from .systems.examples import EXAMPLES as EXAMPLES
