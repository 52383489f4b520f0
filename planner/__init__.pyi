from .controllability.gaits import (
    MAX_DEPTH as MAX_DEPTH,
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
from .execution.execution import (
    Coordinates as Coordinates,
    Execution as Execution,
    StanceRule as StanceRule,
)
from .execution.repositioning import reposition_legs as reposition_legs
from .execution.stepping import (
    StabilityTest as StabilityTest,
    stepped as stepped,
)
from .extension.bracket_fields import hall_fields as hall_fields
from .extension.choice import choose_elements as choose_elements
from .extension.decoupling import require_decoupled as require_decoupled
from .extension.direction_costs import (
    AFFORDABLE as AFFORDABLE,
    DirectionCost as DirectionCost,
    stroke_costs as stroke_costs,
)
from .extension.extended import (
    ExtendedSystem as ExtendedSystem,
    extend as extend,
)
from .extension.fields_on_bottom import (
    on_bottom as on_bottom,
    tangent_field as tangent_field,
)
from .extension.height_functions import (
    StratifiedPanels as StratifiedPanels,
    stratified_panels as stratified_panels,
)
from .extension.steering import Steering as Steering
from .lie.adjoint import (
    adjoint_action as adjoint_action,
    coordinate_rates as coordinate_rates,
)
from .lie.coordinates import (
    backward as backward,
    backward_from_forward as backward_from_forward,
    backward_matrix as backward_matrix,
    forward as forward,
    integrate as integrate,
    logarithm as logarithm,
)
from .lie.free_lie import (
    LieAlgebra as LieAlgebra,
    lie_algebra as lie_algebra,
    structure_constants as structure_constants,
)
from .lie.hall import (
    Bracket as Bracket,
    Element as Element,
    degree as degree,
    hall_basis as hall_basis,
    place as place,
)
from .lie.input_words import word as word
from .lie.tensor import Tensor as Tensor
from .numerics.arrays import (
    ROUNDING as ROUNDING,
    Array as Array,
)
from .optimisation.corridor import (
    Tolerance as Tolerance,
    deviation as deviation,
)
from .optimisation.optimise import (
    Criterion as Criterion,
    Objective as Objective,
    Optimiser as Optimiser,
)
from .optimisation.solver import MissingSolverError as MissingSolverError
from .optimisation.stages import (
    Stage as Stage,
    cycle as cycle,
)
from .optimisation.task import (
    Inequality as Inequality,
    Solution as Solution,
    Task as Task,
)
from .planning.algorithm import (
    Plan as Plan,
    plan as plan,
)
from .planning.archive import (
    load_plan as load_plan,
    save_plan as save_plan,
)
from .planning.chained_forms import (
    ChainedForm as ChainedForm,
    FlatOutputs as FlatOutputs,
    chained_form as chained_form,
)
from .planning.convergence import (
    ConvergenceOrder as ConvergenceOrder,
    convergence_order as convergence_order,
    faster as faster,
)
from .planning.critical_steps import critical_step as critical_step
from .planning.curves import (
    formula_curve as formula_curve,
    table_curve as table_curve,
)
from .planning.lifted_ends import (
    plan_between as plan_between,
    set_down as set_down,
    stratum_at as stratum_at,
)
from .planning.nominal import (
    extend_along as extend_along,
    require_segments as require_segments,
)
from .planning.paths import (
    Path as Path,
    ellipse as ellipse,
    ellipse_perimeter as ellipse_perimeter,
    grid as grid,
    line as line,
    recut as recut,
    waypoints as waypoints,
)
from .planning.replanning import (
    Step as Step,
    plan_step as plan_step,
)
from .planning.rollouts import (
    play as play,
    rollout as rollout,
)
from .planning.shooting import (
    Steered as Steered,
    aim as aim,
    steer as steer,
)
from .planning.subdivision import (
    Slack as Slack,
    subdivide as subdivide,
)
from .systems.closure import (
    LieClosure as LieClosure,
    involutive_closure as involutive_closure,
)
from .systems.fields import (
    NumericField as NumericField,
    VectorField as VectorField,
    bracket as bracket,
    rates_with as rates_with,
)
from .systems.flows import (
    Flow as Flow,
    contact_switches as contact_switches,
    flow_map as flow_map,
    merged as merged,
)
from .systems.formulas import (
    RESERVED as RESERVED,
    read_formula as read_formula,
)
from .systems.gait import Gait as Gait
from .systems.gait_order import (
    gait_steps as gait_steps,
    gait_walk as gait_walk,
    walk_switches as walk_switches,
)
from .systems.grouping import regroup as regroup
from .systems.level_sets import LevelSet as LevelSet
from .systems.shape import (
    ShapeCoordinates as ShapeCoordinates,
    ShapeLimits as ShapeLimits,
)
from .systems.strata import StratifiedSystem as StratifiedSystem
