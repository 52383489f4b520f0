from .coordinates import (
    adjoint_action as adjoint_action,
    backward as backward,
    backward_from_forward as backward_from_forward,
    backward_matrix as backward_matrix,
    coordinate_rates as coordinate_rates,
    forward as forward,
    integrate as integrate,
    logarithm as logarithm,
)
from .free_lie import (
    LieAlgebra as LieAlgebra,
    lie_algebra as lie_algebra,
    structure_constants as structure_constants,
)
from .hall import (
    Bracket as Bracket,
    Element as Element,
    degree as degree,
    hall_basis as hall_basis,
    place as place,
)
from .input_words import word as word
from .tensor import Tensor as Tensor
