"""The unit of each input in which words are spelled, and the shape of rectangles.

A word is spelled for generators that move by a length of one in the metric of the
system, or in its joints where all generators with brackets move joints, and that point
the same way however their inputs are counted. A plan then depends neither on units nor
on signs of the inputs, nor on units of coordinates if the metric is declared in them.
The words of the paper, in inputs as declared, are those of `lie.input_words.word`.

The word X Y X^-1 Y^-1 may begin at any corner of a rectangle of any shape. Such words
of one area differ in [X,[X,Y]] and [Y,[X,Y]]: where a corner, which the fields tell,
makes the two cancel, the error of an open-loop plan falls as 1/n with the number of
segments n, otherwise as 1/sqrt(n). A scale for each generator describes the choice: the
unit of its flows, negative if it runs backward.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from math import prod

import numpy as np

from planner.extension.bracket_fields import HallFields, fields_of, renumbered
from planner.lie.free_lie import lie_algebra
from planner.lie.hall import Element, degree, hall_basis
from planner.lie.input_words import logarithm_of_word
from planner.numerics.arrays import ROUNDING, Array
from planner.systems.elements import leaves
from planner.systems.fields import CompiledFields, compile_fields, sample_configurations
from planner.systems.shape import ShapeCoordinates
from planner.systems.strata import StratifiedSystem

EQUAL = 1e-6  # relative difference below which units count as equal
DEGREE = 2  # of the brackets whose words are rectangles
LONGEST_SHAPE = 10.0  # times as long as wide that a rectangle may be
MOST_SIGNED = 6  # generators whose signs are tried, all combinations of them


@dataclass(frozen=True, eq=False)
class InputUnits:
    """Units in which the generators of a system move by a length of one."""

    elements: tuple[Element, ...]  # of the Hall basis over the generators
    entangled: tuple[int, ...]  # numbers of generators with brackets, from 1
    generators: CompiledFields
    weights: Array  # of the metric, shape (n,)
    joints: Array  # coordinates that count alone where they can, (n,), bool

    def at(self, x: Array) -> Array:
        """Inverse lengths of the generators at configurations (..., n), (..., m)."""
        lengths = self._lengths(x)
        if not (lengths > 0.0).all():
            around = self._lengths(x[..., None, :] + self._nearby)
            squares = np.where(np.isfinite(around), around, 0.0) ** 2
            near = np.sqrt(squares.mean(axis=-2))
            lengths = np.where(lengths > 0.0, lengths, np.where(near > 0.0, near, 1.0))
        return 1.0 / lengths

    def measured(self, hall_coordinates: Array, at: Array) -> tuple[Array, Array]:
        """Coordinates without their rounding, and a unit for each input and segment.

        Takes backward coordinates (segments, s), and the configurations (segments, n)
        where segments start. Coordinates that move by less than `ROUNDING` of the
        largest motion, or of where it starts from, are zero. Units (segments, m) have a
        sign, are the same for generators of one length, and are multiples of the size
        of a segment's flows, so that what is small beside one is rounding.
        """
        units = self.at(at)
        motions = np.abs(hall_coordinates / weights(self.elements, units))
        where = np.abs(at * self.weights).max()
        largest = np.maximum(motions.max(axis=1, keepdims=True), where)
        rounded = motions <= ROUNDING * largest
        degrees = np.array([degree(element) for element in self.elements])
        sizes = np.where(rounded, 0.0, motions ** (1 / degrees)).max(axis=1)
        common = units.copy()
        if places := [number - 1 for number in self.entangled]:
            mean = np.exp(np.log(units[:, places]).mean(axis=1, keepdims=True))
            common[:, places] = mean
        ratios = units / common
        ratios = np.where(np.abs(ratios - 1.0) < EQUAL, 1.0, ratios)
        common *= np.where(sizes > 0.0, sizes, 1.0)[:, None]
        scales = self._senses * ratios * np.exp2(np.rint(np.log2(common)))
        return np.where(rounded, 0.0, hall_coordinates), scales

    def _lengths(self, x: Array) -> Array:
        """Lengths of the generators; 0 where one vanishes or is not finite."""
        lengths = np.linalg.norm(self.generators.values(x) * self._counted, axis=-2)
        return np.where(np.isfinite(lengths), lengths, 0.0)

    @cached_property
    def _counted(self) -> Array:
        """Weights of the coordinates that count for each generator, shape (n, m)."""
        moves = (self.generators.constant[self.joints] != 0.0).any(axis=0)  # (m,)
        clashing = [number - 1 for number in self.entangled]
        alone = self.joints[:, None] & moves & moves[clashing].all()
        return self.weights[:, None] * (alone | ~alone.any(axis=0))

    @cached_property
    def _nearby(self) -> Array:
        """Configurations around zero, up to about one away in each coordinate."""
        return sample_configurations(len(self.weights)) / self.weights

    @cached_property
    def _senses(self) -> Array:
        """Signs of the generators with which they count as running forward.

        One that moves several joints runs the way of the body at zero, whichever way
        the joints are counted; mean rates of any other add up to more than 0.
        """
        values = self.generators.values(self._nearby) * self.weights[:, None]
        rates = values[np.isfinite(values).all(axis=(1, 2))].sum(axis=0)  # (n, m)
        sizes = np.abs(rates)
        first = (sizes >= (1.0 - EQUAL) * sizes.max(axis=0)).argmax(axis=0)
        largest = np.take_along_axis(rates, first[None], axis=0)[0]
        added = rates.sum(axis=0)
        ahead = np.where(np.abs(added) > EQUAL * sizes.sum(axis=0), added, largest)
        several = (self.generators.constant[self.joints] != 0.0).sum(axis=0) > 1
        zero = self.generators.values(np.zeros(len(self.weights)))
        moving = np.where(np.isfinite(zero), zero * self.weights[:, None], 0.0)
        body = moving[~self.joints]
        way = body.sum(axis=0)
        moved = several & (np.abs(way) > EQUAL * np.abs(body).sum(axis=0))
        return np.where(np.where(moved, way, ahead) < 0.0, -1.0, 1.0)


def weights(elements: Sequence[Element], scales: Array) -> Array:
    """Factors by which scales of the generators multiply elements, shape (..., s).

    The scales have shape (..., m), and there are s elements.
    """
    columns = [prod(scales[..., i - 1] for i in leaves(e)) for e in elements]
    return np.stack(columns, axis=-1)


@dataclass(frozen=True, eq=False)
class Rectangles:
    """Corners and shapes of rectangles, compared by the brackets of the next degree."""

    hall: HallFields
    units: InputUnits
    fields: CompiledFields | None  # of the basis and beyond; None if not of degree 2

    def scales(self, hall_coordinates: Array, at: Array, units: Array) -> Array:
        """A scale for each generator and segment, shape (segments, m).

        Arguments are those of `InputUnits.measured`, and the units that it gives.
        """
        if self.fields is None or not hall_coordinates[:, self._tops].any():
            return units
        fields = self.fields.values(at)  # (segments, n, basis and brackets beyond)
        if not np.isfinite(fields).all():
            return units
        fields *= self.units.weights[:, None]
        own, beyond = np.split(fields, [len(self.hall.elements)], axis=-1)
        scales = units * self._sides(beyond * weights(self._beyond, units)[:, None])
        factors = weights(self.hall.elements, scales)
        further = beyond * weights(self._beyond, scales)[:, None]
        own = own * factors[:, None]
        errors = self._errors(hall_coordinates / factors, own, further)
        least = errors.min(axis=0) + EQUAL * errors.max(axis=0)
        printed = errors[0] * 0.5 <= least  # then that word is kept
        turned = self._signs[np.where(printed, 0, errors.argmin(axis=0))]
        return np.asarray(scales * turned)

    def _errors(self, h: Array, own: Array, beyond: Array) -> Array:
        """Leading errors of all ways relative to the intended motion, (ways, segments).

        Takes Hall coordinates (segments, s), the fields of the basis (segments, n, s),
        and the brackets of the next degree (segments, n, m).
        """
        amounts = h[:, self._tops]
        size = np.abs(amounts) ** (1 / DEGREE)  # (segments, tops)
        powers = np.sign(amounts) * size ** (DEGREE + 1)
        terms = np.einsum("wtm,st->wsm", self._leading, powers)
        missed = np.einsum("wsm,snm->wsn", terms, beyond)
        degrees = np.array([degree(e) for e in self.hall.elements])
        motions = np.abs(own * size.max(axis=1)[:, None, None] ** degrees)
        moved = motions.max(axis=-1)  # (segments, n)
        return np.linalg.norm(missed / np.where(moved, moved, 1.0), axis=-1)

    def _sides(self, beyond: Array) -> Array:
        """Scales that make the two halves of the error alike, where they are parallel.

        For a pair X, Y the brackets of the next degree, shape (segments, n, m), are
        [X,[X,Y]] and [Y,[X,Y]].
        """
        scales = np.ones((len(beyond), len(self.hall.generators)))
        if self.hall.only_pair is None:
            return scales
        pair = [number - 1 for number in self.hall.only_pair]
        first, second = np.moveaxis(beyond, -1, 0)
        one, two = np.linalg.norm(first, axis=-1), np.linalg.norm(second, axis=-1)
        along = np.abs((first * second).sum(axis=-1))
        parallel = (along > (1 - EQUAL) * one * two) & (along > 0)
        ratio = np.where(parallel, two, 1.0) / np.where(parallel, one, 1.0)
        ratio = np.where(np.abs(ratio - 1) < EQUAL, 1.0, ratio)
        root = np.sqrt(np.clip(ratio, 1 / LONGEST_SHAPE, LONGEST_SHAPE))
        scales[:, pair] = np.stack([root, 1 / root], axis=-1)
        return scales

    @cached_property
    def _tops(self) -> list[int]:
        """Places of the brackets of the highest degree that move anything."""
        tops = [(j, e) for j, e in enumerate(self.hall.elements) if degree(e) == DEGREE]
        return [j for j, e in tops if e not in self.hall.vanishing]

    @cached_property
    def _beyond(self) -> tuple[Element, ...]:
        return tuple(e for e in _entangled(self.hall) if degree(e) > DEGREE)

    @cached_property
    def _signs(self) -> Array:
        """Ways to sign the generators, the printed one first, shape (ways, m)."""
        tried = self.hall.entangled[1:MOST_SIGNED]  # all at once change no size
        return sign_choices(len(self.hall.generators), tried)

    @cached_property
    def _leading(self) -> Array:
        """Next brackets in the words of unit amounts, shape (ways, tops, brackets)."""
        small = hall_basis(len(self.hall.entangled), DEGREE + 1)
        algebra = lie_algebra(small)
        own = dict(zip(_entangled(self.hall), small, strict=True))
        tops = [self.hall.elements[j] for j in self._tops]
        places = [algebra.index[own[e]] for e in self._beyond]
        printed = np.array([logarithm_of_word(algebra, own[e])[places] for e in tops])
        top_signs = weights(tops, self._signs)  # (ways, tops)
        next_signs = weights(self._beyond, self._signs)  # (ways, brackets)
        return top_signs[..., None] * next_signs[:, None] * printed


def rectangles(system: StratifiedSystem, hall: HallFields) -> Rectangles:
    """The units and rectangles of the words of a basis."""
    generators = [system.fields[name] for name in hall.generators]
    compiled = compile_fields(generators, system.state)
    joints = np.isin(np.arange(system.dimension), list(ShapeCoordinates(system).inert))
    units = InputUnits(hall.elements, hall.entangled, compiled, system.weights, joints)
    if degree(hall.elements[-1]) != DEGREE:
        return Rectangles(hall, units, None)
    every = fields_of(_entangled(hall), generators, system.state)
    brackets = [field for e, field in every.items() if degree(e) > DEGREE]
    fields = compile_fields([*hall.fields, *brackets], system.state)
    return Rectangles(hall, units, fields)


def _entangled(hall: HallFields) -> list[Element]:
    """Hall elements to degree 3 over the generators that do not commute with all."""
    small = hall_basis(len(hall.entangled), DEGREE + 1)
    return [renumbered(e, hall.entangled) for e in small]


def sign_choices(count: int, numbers: Sequence[int]) -> Array:
    """All signs of generators with given numbers, from 1, the printed ones first.

    The other generators run as they are printed; shape (ways, count).
    """
    ways = np.ones((2 ** len(numbers), count))
    ways[:, [i - 1 for i in numbers]] = list(product((1, -1), repeat=len(numbers)))
    return ways
