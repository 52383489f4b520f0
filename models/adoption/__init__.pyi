from .draft import propose as propose
from .standing import servo_for as servo_for
