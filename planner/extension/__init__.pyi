from .bracket_fields import hall_fields as hall_fields
from .choice import choose_elements as choose_elements
from .direction_costs import (
    AFFORDABLE as AFFORDABLE,
    DirectionCost as DirectionCost,
    stroke_costs as stroke_costs,
)
from .extended import ExtendedSystem as ExtendedSystem, extend as extend
from .fields_on_bottom import (
    on_bottom as on_bottom,
    require_decoupled as require_decoupled,
    tangent_field as tangent_field,
)
from .height_functions import (
    StratifiedPanels as StratifiedPanels,
    stratified_panels as stratified_panels,
)
from .steering import Steering as Steering
