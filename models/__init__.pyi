from .adoption.draft import (
    Draft as Draft,
    draft_card as draft_card,
)
from .adoption.source import (
    Source as Source,
    source_of as source_of,
)
from .contact.ground import Ground as Ground
from .contact.kinematics import Kinematics as Kinematics
from .contact.loads import StaticStability as StaticStability
from .contact.paper_stance import PaperStance as PaperStance
from .description.card import Card as Card
from .description.makes import SERVO_KINDS as SERVO_KINDS
from .description.robot import Robot as Robot
from .description.servos import (
    JointServo as JointServo,
    ServoKind as ServoKind,
)
from .errors import (
    MeasurementError as MeasurementError,
    ModelError as ModelError,
    ProblemError as ProblemError,
    UnknownRobotError as UnknownRobotError,
)
from .library import (
    load as load,
    shipped_robots as shipped_robots,
)
from .motion.mobility import (
    Mobility as Mobility,
    mobility_of as mobility_of,
)
from .motion.robot_equations import (
    Equations as Equations,
    equations as equations,
)
from .motion.twists import (
    IdealTwists as IdealTwists,
    IdentifiedTwists as IdentifiedTwists,
    QuasiStaticTwists as QuasiStaticTwists,
    TwistModel as TwistModel,
)
from .systems.catalogue import (
    SYSTEMS as SYSTEMS,
    shipped_system as shipped_system,
)
from .systems.file import load_system as load_system
from .systems.hexapods import paper_hexapod as paper_hexapod
from .systems.problem import Problem as Problem
