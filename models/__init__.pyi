from .adoption.draft import Draft as Draft, draft_card as draft_card
from .adoption.source import Source as Source, source_of as source_of
from .contact.kinematics import Kinematics as Kinematics
from .contact.loads import (
    PaperStance as PaperStance,
    StaticStability as StaticStability,
)
from .contact.sliding import Ground as Ground
from .description.card import Card as Card
from .description.robot import Robot as Robot
from .description.servos import (
    SERVO_KINDS as SERVO_KINDS,
    JointServo as JointServo,
    ServoKind as ServoKind,
)
from .errors import (
    MeasurementError as MeasurementError,
    ModelError as ModelError,
    ProblemError as ProblemError,
    UnknownRobotError as UnknownRobotError,
)
from .library import load as load, shipped_robots as shipped_robots
from .motion.robot_equations import (
    Equations as Equations,
    Mobility as Mobility,
    equations as equations,
    mobility_of as mobility_of,
)
from .motion.twists import (
    IdealTwists as IdealTwists,
    IdentifiedTwists as IdentifiedTwists,
    QuasiStaticTwists as QuasiStaticTwists,
    TwistModel as TwistModel,
)
from .systems.catalogue import (
    SYSTEMS as SYSTEMS,
    load_system as load_system,
    shipped_system as shipped_system,
)
from .systems.legged import paper_hexapod as paper_hexapod
from .systems.problem import Problem as Problem
