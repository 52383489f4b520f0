from .algorithm import Plan as Plan, plan as plan
from .archive import (
    load_plan as load_plan,
    save_plan as save_plan,
    system_table as system_table,
)
from .chained_forms import (
    ChainedForm as ChainedForm,
    FlatOutputs as FlatOutputs,
    chained_form as chained_form,
)
from .convergence import (
    ConvergenceOrder as ConvergenceOrder,
    convergence_order as convergence_order,
    faster as faster,
)
from .critical_steps import (
    critical_step as critical_step,
    least_critical_step as least_critical_step,
)
from .lifted_ends import (
    plan_between as plan_between,
    set_down as set_down,
    stratum_at as stratum_at,
)
from .nominal import extend_along as extend_along, require_segments as require_segments
from .paths import (
    Path as Path,
    ellipse as ellipse,
    ellipse_perimeter as ellipse_perimeter,
    formula_curve as formula_curve,
    grid as grid,
    line as line,
    recut as recut,
    table_curve as table_curve,
    waypoints as waypoints,
)
from .rollouts import play as play, rollout as rollout
from .shooting import (
    Steered as Steered,
    Step as Step,
    aim as aim,
    plan_step as plan_step,
    steer as steer,
)
from .subdivision import Slack as Slack, subdivide as subdivide
