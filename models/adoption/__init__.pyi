from .anatomy import fitting_rotor as fitting_rotor, servo_for as servo_for
from .draft import propose as propose
