from .draft import propose as propose
from .standing import (
    fitting_rotor as fitting_rotor,
    servo_for as servo_for,
)
