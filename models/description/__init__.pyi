from .actuators import (
    ON_JOINT as ON_JOINT,
    actuator_of as actuator_of,
    actuators_driving as actuators_driving,
    actuators_of as actuators_of,
    is_position_servo as is_position_servo,
    position_servos_of as position_servos_of,
)
from .card import CLOCKS as CLOCKS
from .card_file import card_text as card_text, parse_card as parse_card
from .compiled import (
    compile_model as compile_model,
    fixed_to as fixed_to,
    joints_above as joints_above,
    one_line as one_line,
    read_spec as read_spec,
    root_body as root_body,
    silence_the_engine as silence_the_engine,
)
from .inspection import (
    elements_with_files as elements_with_files,
    inspect_model as inspect_model,
)
from .robot import FOLDER as FOLDER
from .servos import (
    ALSO as ALSO,
    BOARD_CLOCK as BOARD_CLOCK,
    BOARD_COUNTS as BOARD_COUNTS,
    KNOWN_SERVOS as KNOWN_SERVOS,
    board_divider as board_divider,
    board_rate as board_rate,
    make_named as make_named,
    servo_of as servo_of,
)
from .table import (
    Table as Table,
    is_plain as is_plain,
    parse_toml as parse_toml,
    toml_key as toml_key,
    toml_text as toml_text,
    without_tables as without_tables,
)
