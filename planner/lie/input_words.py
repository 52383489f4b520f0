"""Bracket motions u_1 o u_2 o -u_1 o -u_2, eq. (20), as words of real inputs, Sec. 2.1.

A word, as Lafferriere and Sussmann call it, lists generators, counted from 1, and
signed durations in time order. The flow along a bracket is approximated by the
commutator word of its parts. This word also moves along brackets of higher degree; that
motion is subtracted from the coordinates that remain to be realised. The whole word is
therefore exact, at any degree, wherever brackets beyond the basis vanish. Other words
that reach the same Hall coordinates are mirrored, or shorter.
"""

from collections.abc import Collection, Iterable, Sequence
from functools import cache
from typing import Any, Literal, TypeVar, get_args

import numpy as np
from numpy.typing import ArrayLike

from planner.errors import message
from planner.lie.coordinates import backward_from_forward, exponential, forward
from planner.lie.free_lie import LieAlgebra, lie_algebra
from planner.lie.hall import Bracket, Element
from planner.numerics.arrays import Array

Order = Literal["backward", "forward"]
Spelling = tuple[tuple[int, ...], list[float]]  # generators, and their durations
T = TypeVar("T", int, Array)

ZERO_DURATION = 1e-12  # in degree k such an error would move by its k-th root


def word(
    basis: Sequence[Element],
    hall_coordinates: ArrayLike,
    order: Order = "backward",
    vanishing: Collection[Element] = (),
) -> list[tuple[int, float]]:
    """Flows of generators that realise backward Hall coordinates, eq. (20).

    Args:
        basis: Hall elements, s of them.
        hall_coordinates: Backward coordinates, shape (s,).
        order: `backward` runs the words of B_s, ..., B_1, `forward` those of B_1, ...,
            B_s; both end at the same point where brackets beyond the basis vanish.
        vanishing: Elements whose fields are zero, so that they need no flow.

    Returns:
        Generators, from 1, and signed durations in time order. Consecutive generators
        differ.

    Raises:
        ValueError: The coordinates are not finite or misshapen, or the order is
            unknown.

    Example:
        >>> from planner import hall_basis, word
        >>> word(hall_basis(2, 2), [0, 0, 1])
        [(1, 1.0), (2, 1.0), (1, -1.0), (2, -1.0)]
    """
    h = _shaped(1, lie_algebra(tuple(basis)).vector(hall_coordinates))
    ((generators, durations),) = spellings(basis, h[None], order, vanishing)
    return list(zip(generators, durations, strict=True))


def spellings(
    basis: Sequence[Element],
    hall_coordinates: ArrayLike,
    order: Order = "backward",
    vanishing: Collection[Element] = (),
    *,
    turned: bool = False,
    units: Array | None = None,
) -> list[Spelling]:
    """Words of many segments, with the generators apart from the durations.

    Many segments share their generators. The first arguments are those of `word`, for
    many segments. If `turned`, the generators themselves run in the other order. The
    durations are multiplied by `units`, shape (segments, generators), at the end.
    """
    algebra = lie_algebra(tuple(basis))
    h = _shaped(2, algebra.vector(hall_coordinates))
    if units is None:
        units = np.ones((len(h), algebra.degrees.count(1)))
    if order not in get_args(Order):
        raise ValueError(f"order is {order!r}; choose backward or forward")
    # -f are the backward coordinates of the inverse flow; its word is inverted, too.
    back = order == "forward"
    amounts = _amounts(algebra, -forward(basis, h) if back else h, vanishing, turned)
    return _spelled(algebra, amounts, units, back, turned)


def _shaped(axes: int, h: Array) -> Array:
    if h.ndim != axes:
        raise ValueError(message("axes", shape=h.shape, given=h.ndim, axes=axes))
    return h


def _places(algebra: LieAlgebra, turned: bool) -> tuple[int, ...]:
    """Places of the elements in the order in which their words are split off."""
    generators = algebra.degrees.count(1)
    first = range(generators)
    rest = range(generators, len(algebra.basis))
    return (*(reversed(first) if turned else first), *rest)


def _amounts(
    algebra: LieAlgebra, h: Array, vanishing: Collection[Element], turned: bool
) -> Array:
    """Coordinate that the word of each element has to realise, shape (segments, s).

    The words are split off the right of the flow one by one, lower degrees first; the
    remaining flow has the backward coordinates `rest`.
    """
    amounts, rest = np.zeros_like(h), h.copy()
    degrees, inside = algebra.degrees, 0 if turned else 1
    for j in _places(algebra, turned):  # the first is at the right end unless turned
        if algebra.basis[j] not in vanishing:
            own = np.where(np.abs(rest[:, j]) < ZERO_DURATION, 0.0, rest[:, j])
            amounts[:, j] = own
            if inside < degrees[j] < algebra.max_degree and own.any():
                scale = np.abs(own) ** (1 / degrees[j])
                powers = np.sign(own)[:, None] * scale[:, None] ** np.array(degrees)
                undone = -(powers * logarithm_of_word(algebra, algebra.basis[j]))
                rest = exponential(algebra.basis, undone, rest)
        rest[:, j] = 0.0
    return amounts


@cache
def logarithm_of_word(algebra: LieAlgebra, element: Element) -> Array:
    """Logarithm of the word of an element with durations of one, shape (s,)."""
    if not isinstance(element, Bracket):
        return np.eye(len(algebra.basis))[algebra.index[element]]
    left = logarithm_of_word(algebra, element.left)
    right = logarithm_of_word(algebra, element.right)
    join = algebra.campbell_baker_hausdorff
    return join(join(left, right), join(-left, -right))


@cache
def letters_of(element: Element) -> tuple[tuple[Any, int], ...]:
    """The word of an element and its signs: A C A^-1 C^-1 for [A, C], eq. (20)."""
    if not isinstance(element, Bracket):
        return ((element, 1),)
    left, right = letters_of(element.left), letters_of(element.right)
    return (*left, *right, *_inverse(left), *_inverse(right))


def _spelled(
    algebra: LieAlgebra, amounts: Array, units: Array, back: bool, turned: bool
) -> list[Spelling]:
    """Words for amounts of all elements, the last element first; or their inverses.

    Segments whose amounts have the same signs share their generators.
    """
    sizes = np.abs(amounts) ** (1 / np.array(algebra.degrees))
    alike: dict[tuple[int, ...], list[int]] = {}
    for segment, signs in enumerate(np.sign(amounts).astype(int).tolist()):
        alike.setdefault(tuple(signs), []).append(segment)
    spelled: list[Spelling] = [((), [])] * len(amounts)
    for signs, segments in alike.items():
        generators, parts = _pattern(algebra, signs, back, turned)
        durations = sizes[segments] @ parts.T
        brief = np.flatnonzero((np.abs(durations) < ZERO_DURATION).any(axis=-1))
        pruned = [joined(generators, durations[i].tolist()) for i in brief]
        durations *= units[segments][:, np.array(generators, dtype=int) - 1]
        for segment, row in zip(segments, durations.tolist(), strict=True):
            spelled[segment] = generators, row
        for i, word in zip(brief, pruned, strict=True):
            spelled[segments[i]] = scaled(word, units[segments[i]])
    return spelled


def scaled(spelling: Spelling, units: Array) -> Spelling:
    """A word with its durations in the units of the generators, shape (m,)."""
    letters, durations = spelling
    own = units.tolist()
    return letters, [own[i - 1] * t for i, t in zip(letters, durations, strict=True)]


@cache
def _pattern(
    algebra: LieAlgebra, signs: tuple[int, ...], back: bool, turned: bool
) -> tuple[tuple[int, ...], Array]:
    """Generators of the words for amounts of given signs, and coefficients.

    With the coefficients, of shape (flows, s), durations are sums of the sizes of the
    amounts, each to the power of one over its degree.
    """
    letters: list[tuple[int, Array]] = []
    units = np.eye(len(signs), dtype=int)
    for j in _places(algebra, turned):
        word = [(i, sense * units[j]) for i, sense in letters_of(algebra.basis[j])]
        if signs[j]:
            letters = (_inverse(word) if signs[j] < 0 else word) + letters
    generators: list[int] = []
    durations: list[Array] = []
    for generator, duration in _inverse(letters) if back else letters:
        if generators and generators[-1] == generator:
            durations[-1] = durations[-1] + duration
        else:
            generators.append(generator)
            durations.append(duration)
    return tuple(generators), np.array(durations).reshape(-1, len(signs))


def _inverse(letters: Sequence[tuple[int, T]]) -> list[tuple[int, T]]:
    """The inverse word: the same flows in reverse."""
    return [(generator, -amount) for generator, amount in reversed(letters)]


def joined(generators: Iterable[int], durations: Iterable[float]) -> Spelling:
    """Drop flows of negligible duration, and join the neighbours of one generator."""
    letters: list[int] = []
    together: list[float] = []
    for generator, duration in zip(generators, durations, strict=True):
        if letters and letters[-1] == generator:
            letters.pop()
            duration += together.pop()
        if abs(duration) >= ZERO_DURATION:
            letters.append(generator)
            together.append(duration)
    return tuple(letters), together


def mirrored_spellings(
    basis: Sequence[Element],
    hall_coordinates: Array,
    bracket_degree: int,
    vanishing: Collection[Element] = (),
) -> list[Spelling]:
    """Mirror images of backward words, which realise the same backward coordinates.

    Changing the sign of all generators multiplies an element of degree d by (-1)^d, and
    reversing the order of the flows by (-1)^(d + 1). The former leaves brackets of even
    degree unchanged, the latter those of odd degree; `bracket_degree`, of those that
    the words approximate, chooses between them. A word that is exact to a degree of the
    same parity misses its goal by brackets of one degree more, and this error changes
    its sign: a word and its mirror image together cancel it, without further flows.
    Coordinates have shape (segments, s); `vanishing` is as in `word`.
    """
    signs = (-1.0) ** np.array(lie_algebra(tuple(basis)).degrees)
    if bracket_degree % 2 == 0:
        words = spellings(basis, hall_coordinates * signs, "backward", vanishing)
        return [(letters, [-t for t in times]) for letters, times in words]
    turned = backward_from_forward(basis, -signs * hall_coordinates)
    words = spellings(basis, turned, "backward", vanishing)
    return [(letters[::-1], times[::-1]) for letters, times in words]


def short_durations(first: Array, second: Array, bracket: Array) -> Array:
    """Durations of the shortest word of five flows X, Y, X, Y, X, (segments, 5).

    It is for two fields whose only bracket is [X,Y], in backward coordinates hX, hY and
    h of shape (segments,). Sides of the rectangle that realises the bracket also serve
    as the flows along X and Y: Y^(hY-q) X^p Y^q X^(hX-p) with p q = h, or
    X^(hX+p) Y^q X^-p Y^(hY-q) with p q = h - hX hY. No word of any other form is
    shorter up to brackets of degree 3.
    """
    p, q = _rectangles(bracket, first, second)
    starting_with_second = np.stack([0 * p, second - q, p, q, first - p], axis=-1)
    p, q = _rectangles(bracket - first * second, -first, second)
    starting_with_first = np.stack([first + p, q, -p, second - q, 0 * p], axis=-1)
    words = np.concatenate([starting_with_second, starting_with_first])
    return words[np.abs(words).sum(axis=-1).argmin(axis=0), np.arange(len(first))]


def _rectangles(area: Array, width: Array, height: Array) -> tuple[Array, Array]:
    """Candidate sides p, q with p q = area, shape (candidates, segments).

    The length |p| + |p - width| + |q| + |q - height| is least for a square, or where a
    side makes one of the flows vanish.
    """
    area = np.where(np.abs(area) < ZERO_DURATION, 0.0, area)
    root = np.sqrt(np.abs(area))
    with np.errstate(divide="ignore", invalid="ignore"):
        p = np.stack([root, -root, width, area / height])
        q = area / p
    usable = np.isfinite(p) & np.isfinite(q)
    return np.where(usable, p, root), np.where(usable, q, np.sign(area) * root)
