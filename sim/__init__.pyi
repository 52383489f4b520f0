from .errors import (
    FilesError as FilesError,
    RenderError as RenderError,
    SimulationError as SimulationError,
    StratawalkError as StratawalkError,
    UsageError as UsageError,
)
from .evaluation.assessment import Evaluation as Evaluation, evaluate as evaluate
from .evaluation.deviations import error_sources as error_sources
from .feedback.filter import Feedback as Feedback
from .feedback.sensing import Sensing as Sensing
from .optimisation.judging import Judge as Judge
from .optimisation.lower_bound import least_time as least_time
from .preparation.setup import prepare as prepare
from .problems.scenario import ScenarioProblem as ScenarioProblem
from .run_folder import film as film, write as write
from .scenarios.file import (
    load_scenario as load_scenario,
    shipped_scenarios as shipped_scenarios,
)
from .scenarios.scenario import Scenario as Scenario
from .simulation import Simulation as Simulation, play as play, simulate as simulate
from .walking.finished import Walk as Walk
from .walking.walks import walk as walk
