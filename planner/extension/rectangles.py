"""The corner and the shape of the rectangle that realises a bracket.

The word X Y X^-1 Y^-1 may begin at any of its four corners, and rectangles of different
shapes may have the same area. All of these words realise the bracket [X,Y]. They differ
in [X,[X,Y]] and [Y,[X,Y]], which cause the error of an open-loop plan: where a corner
makes the two cancel, it falls as 1/n with the number of segments n, otherwise as
1/sqrt(n). Which corner this is depends on the signs and units of the fields, and is
therefore determined from the fields and not taken from the order in the paper. Words of
degree 3 and more are judged by where they end: `execution.nearest_words`.

A choice is described by a scale for each generator: its flows are measured in units of
the scale, and a negative scale runs the generator backward. Scales begin with the units
of `extension.input_units`; at other degrees there is nothing else to choose.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np

from planner.extension.bracket_fields import HallFields, fields_of, renumbered
from planner.extension.input_units import EQUAL, InputUnits, weights
from planner.lie.free_lie import lie_algebra
from planner.lie.hall import Element, degree, hall_basis
from planner.lie.input_words import logarithm_of_word
from planner.numerics.arrays import Array
from planner.systems.fields import CompiledFields, compile_fields
from planner.systems.shape import ShapeCoordinates
from planner.systems.strata import StratifiedSystem

DEGREE = 2  # of the brackets whose words are rectangles
WORTH_TURNING = 0.5  # of the printed word's error, above which that word is kept
LONGEST_SHAPE = 10.0  # times as long as wide that a rectangle may be
MOST_SIGNED = 6  # generators whose signs are tried, all combinations of them


@dataclass(frozen=True, eq=False)
class Rectangles:
    """Corners and shapes of rectangles, compared by the brackets of the next degree."""

    hall: HallFields
    units: InputUnits
    fields: CompiledFields | None  # of the basis and beyond; None if not of degree 2

    def scales(self, hall_coordinates: Array, at: Array, units: Array) -> Array:
        """A scale for each generator and segment, shape (segments, m).

        Takes backward coordinates, shape (segments, s), the configurations where
        segments start, (segments, n), and the units of the inputs, (segments, m).
        """
        scales = units
        if self.fields is None or not hall_coordinates[:, self._tops].any():
            return scales
        fields = self.fields.values(at)  # (segments, n, basis and brackets beyond)
        if not np.isfinite(fields).all():
            return scales
        fields *= self.units.weights[:, None]
        own, beyond = np.split(fields, [len(self.hall.elements)], axis=-1)
        scales = scales * self._sides(beyond * self._weights(self._beyond, scales))
        errors = self._errors(
            hall_coordinates / weights(self.hall.elements, scales),
            own * self._weights(self.hall.elements, scales),
            beyond * self._weights(self._beyond, scales),
        )  # (ways, segments)
        least = errors.min(axis=0) + EQUAL * errors.max(axis=0)
        printed = errors[0] * WORTH_TURNING <= least
        turned = self._signs[np.where(printed, 0, errors.argmin(axis=0))]
        return np.asarray(scales * turned)

    def _weights(self, elements: Sequence[Element], scales: Array) -> Array:
        """Factors of the columns of fields in each segment, (segments, 1, elements)."""
        return weights(elements, scales)[:, None]

    def _errors(self, h: Array, own: Array, beyond: Array) -> Array:
        """Leading errors of all ways relative to the intended motion, (ways, segments).

        Takes Hall coordinates, shape (segments, s), the fields of the basis, shape
        (segments, n, s), and the brackets of the next degree, shape (segments, n, m).
        """
        amounts = h[:, self._tops]
        size = np.abs(amounts) ** (1 / DEGREE)  # (segments, tops)
        powers = np.sign(amounts) * size ** (DEGREE + 1)
        terms = np.einsum("wtm,st->wsm", self._leading, powers)
        missed = np.einsum("wsm,snm->wsn", terms, beyond)
        degrees = np.array([degree(e) for e in self.hall.elements])
        motions = np.abs(own * size.max(axis=1)[:, None, None] ** degrees)
        moved = motions.max(axis=-1)  # (segments, n)
        errors: Array = np.linalg.norm(missed / np.where(moved, moved, 1.0), axis=-1)
        return errors

    def _sides(self, beyond: Array) -> Array:
        """Scales that make the two halves of the error alike, where they are parallel.

        For a pair X, Y the brackets of the next degree, shape (segments, n, m), are
        [X,[X,Y]] and [Y,[X,Y]].
        """
        scales = np.ones((len(beyond), len(self.hall.generators)))
        if self._pair is None:
            return scales
        first, second = np.moveaxis(beyond, -1, 0)
        one, two = np.linalg.norm(first, axis=-1), np.linalg.norm(second, axis=-1)
        along = np.abs((first * second).sum(axis=-1))
        parallel = (along > (1 - EQUAL) * one * two) & (along > 0)
        ratio = np.where(parallel, two, 1.0) / np.where(parallel, one, 1.0)
        ratio = np.where(np.abs(ratio - 1) < EQUAL, 1.0, ratio)
        root = np.sqrt(np.clip(ratio, 1 / LONGEST_SHAPE, LONGEST_SHAPE))
        scales[:, self._pair] = np.stack([root, 1 / root], axis=-1)
        return scales

    @cached_property
    def _tops(self) -> list[int]:
        """Places of the brackets of the highest degree that move anything."""
        return [
            j
            for j, element in enumerate(self.hall.elements)
            if degree(element) == DEGREE and element not in self.hall.vanishing
        ]

    @cached_property
    def _pair(self) -> list[int] | None:
        pair = self.hall.only_pair
        return pair and [number - 1 for number in pair]

    @cached_property
    def _beyond(self) -> tuple[Element, ...]:
        return tuple(e for e in entangled(self.hall) if degree(e) > DEGREE)

    @cached_property
    def _signs(self) -> Array:
        """Ways to sign the generators, the printed one first, shape (ways, m)."""
        tried = self.hall.entangled[1:MOST_SIGNED]  # all at once change no size
        return sign_choices(len(self.hall.generators), tried)

    @cached_property
    def _leading(self) -> Array:
        """Next brackets in the words of unit amounts, shape (ways, tops, brackets)."""
        small = _small_basis(self.hall)
        algebra = lie_algebra(small)
        own = dict(zip(entangled(self.hall), small, strict=True))
        tops = [self.hall.elements[j] for j in self._tops]
        places = [algebra.index[own[e]] for e in self._beyond]
        printed = np.array([logarithm_of_word(algebra, own[e])[places] for e in tops])
        top_signs = weights(tops, self._signs)  # (ways, tops)
        next_signs = weights(self._beyond, self._signs)  # (ways, brackets)
        leading: Array = top_signs[..., None] * next_signs[:, None] * printed
        return leading


def rectangles(system: StratifiedSystem, hall: HallFields) -> Rectangles:
    """The units and rectangles of the words of a basis."""
    generators = [system.fields[name] for name in hall.generators]
    compiled = compile_fields(generators, system.state)
    joints = ShapeCoordinates(system).inert
    units = InputUnits(hall.elements, hall.entangled, compiled, system.weights, joints)
    if degree(hall.elements[-1]) != DEGREE:
        return Rectangles(hall, units, None)
    every = fields_of(entangled(hall), generators, system.state)
    brackets = [field for e, field in every.items() if degree(e) > DEGREE]
    fields = compile_fields([*hall.fields, *brackets], system.state)
    return Rectangles(hall, units, fields)


def entangled(hall: HallFields) -> tuple[Element, ...]:
    """Hall elements to degree 3 over the generators that do not commute with all."""
    return tuple(renumbered(e, hall.entangled) for e in _small_basis(hall))


def _small_basis(hall: HallFields) -> tuple[Element, ...]:
    return hall_basis(len(hall.entangled), DEGREE + 1)


def sign_choices(count: int, numbers: Sequence[int]) -> Array:
    """All signs of generators with given numbers, from 1, the printed ones first.

    The other generators run as they are printed; shape (ways, count).
    """
    ways = np.ones((2 ** len(numbers), count))
    ways[:, [i - 1 for i in numbers]] = list(product((1, -1), repeat=len(numbers)))
    return ways
