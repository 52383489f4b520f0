"""The unit of each input, in which words are spelled.

A word is spelled for generators that move by a length of one in the metric of the
system, and point the same way in whatever sense their inputs are counted. Where all
generators with brackets move joints, the way of these alone counts, since it is joints
that have ranges. The flows of a word are then translated to the inputs as they are
declared. So a plan depends neither on units nor on signs of the inputs, at any degree,
nor on the units of coordinates if the metric is declared in the same. Words of the
paper, with inputs as they are declared, are those of `lie.input_words.word`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from planner.lie.hall import Bracket, Element, degree
from planner.numerics.arrays import ROUNDING, Array
from planner.systems.fields import CompiledFields, sample_configurations

EQUAL = 1e-6  # relative difference below which units count as equal


@dataclass(frozen=True, eq=False)
class InputUnits:
    """Units in which the generators of a system move by a length of one."""

    elements: tuple[Element, ...]  # of the Hall basis over the generators
    entangled: tuple[int, ...]  # numbers of generators with brackets, from 1
    generators: CompiledFields
    weights: Array  # of the metric, shape (n,)
    joints: frozenset[int]  # coordinates that count alone where they can

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

        Takes backward coordinates, shape (segments, s), and the configurations where
        segments start, (segments, n). Coordinates that move by less than `ROUNDING` of
        the largest motion, or of where it starts from, are zero. Units have a sign,
        shape (segments, m); generators of one length have the same. They are multiples
        of the size of a segment's flows, a power of two, so that in these units what is
        small beside one is rounding.
        """
        units = self.at(at)
        motions = np.abs(hall_coordinates / weights(self.elements, units))
        where = np.abs(at * self.weights).max()
        largest = np.maximum(motions.max(axis=1, keepdims=True), where)
        rounded = motions <= ROUNDING * largest
        degrees = np.array([degree(element) for element in self.elements])
        sizes = np.where(rounded, 0.0, motions ** (1 / degrees)).max(axis=1)
        common = units.copy()
        if self.entangled:
            places = [number - 1 for number in self.entangled]
            mean = np.exp(np.log(units[:, places]).mean(axis=1, keepdims=True))
            common[:, places] = mean
        ratios = units / common
        ratios = np.where(np.abs(ratios - 1.0) < EQUAL, 1.0, ratios)
        common *= np.where(sizes > 0.0, sizes, 1.0)[:, None]
        scales = self._senses * ratios * np.exp2(np.rint(np.log2(common)))
        return np.where(rounded, 0.0, hall_coordinates), scales

    def _lengths(self, x: Array) -> Array:
        """Lengths of the generators; 0 where one vanishes or is not finite."""
        moved = self.generators.values(x) * self._counted
        lengths = np.linalg.norm(moved, axis=-2)
        return np.where(np.isfinite(lengths), lengths, 0.0)

    @cached_property
    def _counted(self) -> Array:
        """Weights of the coordinates that count for each generator, shape (n, m)."""
        joints = np.isin(np.arange(len(self.weights)), list(self.joints))
        moves = (self.generators.constant[joints] != 0.0).any(axis=0)  # (m,)
        clashing = [number - 1 for number in self.entangled]
        alone = joints[:, None] & moves & moves[clashing].all()
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
        sound = np.isfinite(values).all(axis=(1, 2))
        rates = values[sound].sum(axis=0)  # (n, m)
        sizes = np.abs(rates)
        first = (sizes >= (1.0 - EQUAL) * sizes.max(axis=0)).argmax(axis=0)
        largest = np.take_along_axis(rates, first[None], axis=0)[0]
        added = rates.sum(axis=0)
        told = np.where(np.abs(added) > EQUAL * sizes.sum(axis=0), added, largest)
        joints = np.isin(np.arange(len(self.weights)), list(self.joints))
        several = (self.generators.constant[joints] != 0.0).sum(axis=0) > 1
        zero = self.generators.values(np.zeros(len(self.weights)))
        body = np.where(np.isfinite(zero), zero * self.weights[:, None], 0.0)[~joints]
        way = body.sum(axis=0)
        moved = several & (np.abs(way) > EQUAL * np.abs(body).sum(axis=0))
        signs: Array = np.where(np.where(moved, way, told) < 0.0, -1.0, 1.0)
        return signs


def weights(elements: Sequence[Element], scales: Array) -> Array:
    """Factors by which scales of the generators multiply elements, shape (..., s).

    The scales have shape (..., m), and there are s elements.
    """
    columns = [
        np.prod(scales[..., [i - 1 for i in _letters(e)]], axis=-1) for e in elements
    ]
    return np.stack(columns, axis=-1)


def _letters(element: Element) -> tuple[int, ...]:
    """Generators of an element, as often as they occur."""
    if isinstance(element, Bracket):
        return (*_letters(element.left), *_letters(element.right))
    return (element,)
