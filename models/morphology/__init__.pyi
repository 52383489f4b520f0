from .mjcf import write_mjcf as write_mjcf
from .shipped import (
    FEET as FEET,
    KAPPA as KAPPA,
    MORPHOLOGIES as MORPHOLOGIES,
    PIVOT as PIVOT,
    PIVOTS as PIVOTS,
    geometry_of as geometry_of,
)
