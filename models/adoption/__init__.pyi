from .coupled_swings import (
    Design as Design,
    designs as designs,
)
from .draft import propose as propose
from .standing import servo_for as servo_for
