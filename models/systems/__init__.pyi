from .catalogue import parameters as parameters
from .legged import AIR_SWINGS as AIR_SWINGS
from .problem import configuration as configuration
