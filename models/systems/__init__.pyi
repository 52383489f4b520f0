from .catalogue import parameters as parameters
from .hexapods import paper_hexapod as paper_hexapod
from .legged import AIR_SWINGS as AIR_SWINGS
from .problem import configuration as configuration
