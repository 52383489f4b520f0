"""The truncated tensor algebra on m letters: noncommutative power series, eq. (2).

Formal flows such as S(t) of eq. (6), and their exponentials and logarithms, are
elements of it. Products are in time order: the left factor runs first, as in eq. (2).
Entries are floats, or exact numbers (`fractions.Fraction`) in arrays of dtype object.
"""

from dataclasses import dataclass

from planner.errors import message
from planner.numerics.arrays import Array


@dataclass(frozen=True, eq=False)
class Tensor:
    """A series up to words of length k, or an array of such series.

    Attributes:
        levels: For each length n = 0, ..., k the coefficients of words of n letters,
            shape (..., m**n), words in lexicographic order.
    """

    levels: tuple[Array, ...]

    def __add__(self, other: "Tensor") -> "Tensor":
        pairs = zip(self.levels, other.levels, strict=True)
        return Tensor(tuple(a + b for a, b in pairs))

    def __mul__(self, other: "Tensor") -> "Tensor":
        a, b = self.levels, other.levels
        terms = ([_outer(a[i], b[n - i]) for i in range(n + 1)] for n in range(len(a)))
        return Tensor(tuple(sum(own[1:], own[0]) for own in terms))

    def divided_by(self, number: int) -> "Tensor":
        """The series divided by an integer, exact if its entries are."""
        return Tensor(tuple(level / number for level in self.levels))

    @property
    def unit(self) -> "Tensor":
        """The series 1, with entries of the same type."""
        zeros = [level * 0 for level in self.levels]
        return Tensor((zeros[0] + 1, *zeros[1:]))

    def exp(self) -> "Tensor":
        """The sum of x^n / n!, for a series x without constant term."""
        self._require_constant(0)
        total = power = self.unit
        for n in range(1, len(self.levels)):
            power = (power * self).divided_by(n)
            total = total + power
        return total

    def log(self) -> "Tensor":
        """The sum of (-1)^(n+1) (x - 1)^n / n, for a series x with constant term 1."""
        self._require_constant(1)
        rest = Tensor((self.levels[0] * 0, *self.levels[1:]))
        total = power = rest
        for n in range(2, len(self.levels)):
            power = power * rest
            total = total + power.divided_by(n if n % 2 else -n)
        return total

    def _require_constant(self, number: int) -> None:
        if (self.levels[0] != number).any():
            facts = {"of": "log" if number else "exp", "wanted": number}
            raise ValueError(message("constant", given=self.levels[0].flat[0], **facts))


def _outer(a: Array, b: Array) -> Array:
    """Coefficients of the concatenated words, shape (..., m**i * m**j)."""
    product = a[..., :, None] * b[..., None, :]
    return product.reshape(*product.shape[:-2], -1)
