from .adoption.coupled_swings import (
    Design as Design,
    designs as designs,
)
from .adoption.draft import (
    Draft as Draft,
    Proposal as Proposal,
    draft_card as draft_card,
    propose as propose,
)
from .adoption.source import (
    Source as Source,
    source_of as source_of,
)
from .adoption.standing import servo_for as servo_for
from .checks import UPRIGHT as UPRIGHT
from .contact.ground import (
    Ground as Ground,
    ground_of as ground_of,
)
from .contact.kinematics import (
    Kinematics as Kinematics,
    Lifting as Lifting,
    Stance as Stance,
)
from .contact.loads import (
    StaticStability as StaticStability,
    static_loads as static_loads,
)
from .contact.paper_stance import PaperStance as PaperStance
from .contact.soles import covering_core as covering_core
from .description.card import Card as Card
from .description.card_file import read_card as read_card
from .description.compiled import (
    ON_JOINT as ON_JOINT,
    actuator_of as actuator_of,
    compile_model as compile_model,
    free_joint as free_joint,
    is_position_servo as is_position_servo,
    root_body as root_body,
    silence_the_engine as silence_the_engine,
    weight_of as weight_of,
)
from .description.inspection import (
    elements_with_files as elements_with_files,
    inspect_model as inspect_model,
)
from .description.robot import (
    FOLDER as FOLDER,
    Robot as Robot,
)
from .description.servos import (
    SERVO_KINDS as SERVO_KINDS,
    JointServo as JointServo,
    ServoKind as ServoKind,
)
from .description.table import parse_toml as parse_toml
from .errors import (
    MeasurementError as MeasurementError,
    ModelError as ModelError,
    ProblemError as ProblemError,
    UnknownRobotError as UnknownRobotError,
)
from .library import (
    EMBEDDED as EMBEDDED,
    has_card_inside as has_card_inside,
    load as load,
    shipped_robots as shipped_robots,
)
from .morphology.mjcf import write_mjcf as write_mjcf
from .morphology.shipped import (
    FEET as FEET,
    KAPPA as KAPPA,
    MORPHOLOGIES as MORPHOLOGIES,
    PIVOT as PIVOT,
    PIVOTS as PIVOTS,
)
from .morphology.variants import (
    geometry_of as geometry_of,
    reshaped as reshaped,
)
from .motion.mobility import (
    Mobility as Mobility,
    mobility_of as mobility_of,
)
from .motion.real_contacts import (
    ContactField as ContactField,
    FittedTwists as FittedTwists,
    contact_equations as contact_equations,
    contact_fields as contact_fields,
)
from .motion.robot_equations import (
    Equations as Equations,
    equations as equations,
    group_twist as group_twist,
    strata as strata,
)
from .motion.strokes import (
    Strokes as Strokes,
    travel as travel,
)
from .motion.twists import (
    FailedField as FailedField,
    IdealTwists as IdealTwists,
    IdentifiedTwists as IdentifiedTwists,
    MeasuredField as MeasuredField,
    QuasiStaticTwists as QuasiStaticTwists,
    TwistModel as TwistModel,
)
from .systems.catalogue import (
    SYSTEMS as SYSTEMS,
    parameters as parameters,
    shipped_system as shipped_system,
)
from .systems.file import load_system as load_system
from .systems.hexapods import paper_hexapod as paper_hexapod
from .systems.legged import AIR_SWINGS as AIR_SWINGS
from .systems.problem import (
    Problem as Problem,
    configuration as configuration,
)
