from .real_contacts import (
    ContactField as ContactField,
    contact_equations as contact_equations,
    contact_fields as contact_fields,
)
from .robot_equations import group_twist as group_twist
from .strokes import Strokes as Strokes, Travel as Travel
from .twists import FailedField as FailedField, MeasuredField as MeasuredField
