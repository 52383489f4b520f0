from .anatomy import FASTEST as FASTEST, servo_for as servo_for
from .draft import propose as propose
