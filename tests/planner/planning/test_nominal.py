"""Samples of nominal paths, what is refused of them, and nodes of their segments."""

import re

import numpy as np
import pytest

from models.systems.catalogue import shipped_system
from planner.errors import PlannerError
from planner.extension.extended import extend
from planner.numerics.collocation import collocation
from planner.planning import nominal
from planner.planning.nominal import (
    default_nodes,
    fictitious_inputs_along,
    require_segments,
    require_use,
    sample,
)
from planner.planning.paths import Path, line, waypoints
from planner.systems.flows import Flow
from planner.systems.strata import StratifiedSystem

MOST_SEGMENTS = 100_000  # of one plan; so many take a minute and a gigabyte
OFF_BOTTOM = 1e-6  # by which a path may miss the level sets, in their unit

PLAIN = StratifiedSystem("x y", {"0": {"f": [1, 0], "g": [0, 1]}}, "0")
BENT = waypoints([[0, 0], [1, 0], [1, 3]])


@pytest.mark.parametrize(
    ("segments", "nodes"),
    [(1, 41), (2, 21), (3, 15), (8, 6), (10, 5), (11, 5), (99, 5)],
)
def test_segments_have_forty_intervals_together_and_four_at_least(segments, nodes):
    assert default_nodes(segments) == nodes


@pytest.mark.parametrize("segments", [0, -1, 1.0, True, "3", MOST_SEGMENTS + 1, None])
def test_segments_are_a_whole_number_up_to_the_most(segments):
    message = f"segments is {segments}; a whole number from 1 to 100000 is needed"
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        require_segments(segments, line([0], [1]))
    require_segments(MOST_SEGMENTS, line([0], [1]))
    require_segments(np.int64(1), line([0], [1]))


def test_segments_are_more_than_corners():
    message = "segments is 1, which cuts corners of a path that has 1; plan at least 2"
    with pytest.raises(PlannerError, match=message):
        require_segments(1, BENT)
    require_segments(2, BENT)


@pytest.mark.parametrize(("segments", "nodes"), [(1, 5), (3, 4), (4, 7)])
def test_samples_are_at_the_nodes_of_every_segment(segments, nodes):
    found = sample(BENT, PLAIN, segments, nodes)
    assert found.shape == (segments, nodes, 2)
    cuts = np.linspace(0, 1, segments + 1)
    if segments > 1:
        cuts[1] = 0.25  # the corner
    for part, begin, end in zip(found, cuts, cuts[1:], strict=False):
        places = begin + (end - begin) * collocation(nodes).nodes
        assert part == pytest.approx(BENT.at(places))
    for part, after in zip(found, found[1:], strict=False):
        assert part[-1].tolist() == after[0].tolist()
    assert found[-1, -1].tolist() == BENT(1.0).tolist()


def test_paths_of_another_size_or_that_are_not_finite_are_refused():
    wide = line([0, 0, 0], [1, 1, 1])
    with pytest.raises(ValueError, match=r"shape \(3,\), expected \(2,\): x, y"):
        sample(wide, PLAIN, 2, 5)
    edge = Path(lambda s: np.stack([np.where(s > 0.4, np.nan, s), s], axis=1))
    place = collocation(5).nodes
    first = place[place > 0.4][0]
    with pytest.raises(ValueError, match=f"not finite at s = {first:.6g}"):
        sample(edge, PLAIN, 1, 5)


@pytest.mark.parametrize(("off", "refused"), [(0.99, False), (1.01, True)])
def test_a_path_may_miss_the_bottom_stratum_by_rounding(off, refused):
    system = shipped_system("biped").system
    functions = system.level_set(system.bottom).functions
    foot = system.state.index(functions[1])

    def at(s):
        states = np.zeros((len(s), system.dimension))
        states[:, 0], states[:, foot] = s, off * OFF_BOTTOM * np.isclose(s, 0.5)
        return states

    if refused:
        where = f"leaves S12 at s = 0.5, where {functions[1]} is not 0 at "
        with pytest.raises(ValueError, match=rf"{where}\(0.5, "):
            sample(Path(at), system, 1, 5)
    else:
        assert sample(Path(at), system, 1, 5).shape == (1, 5, system.dimension)


def test_inputs_are_zero_where_a_segment_stands_still():
    car = StratifiedSystem(
        "x y a", {"0": {"drive": ["cos(a)", "sin(a)", 0], "turn": [0, 0, 1]}}, "0"
    )
    extended = extend(car, ["drive", "turn", "[drive,turn]"])
    samples = np.zeros((3, 5, 3))
    samples[1, :, 2] = np.linspace(0, 1, 5)
    samples[1] = line([0, 0, 0], [0, 0, 1]).at(collocation(5).nodes)
    inputs = fictitious_inputs_along(extended, samples)
    assert not inputs[[0, 2]].any()
    assert inputs[1] == pytest.approx(np.tile([0.0, 1.0, 0.0], (5, 1)), abs=1e-12)


def test_a_segment_moves_whose_coordinates_are_equal_at_every_moment():
    extended = extend(PLAIN, ["f", "g"])
    samples = line([0, 0], [1, 1]).at(collocation(5).nodes)[None]
    inputs = fictitious_inputs_along(extended, samples)
    assert inputs == pytest.approx(np.ones((1, 5, 2)))


@pytest.mark.parametrize(
    ("x", "share", "refused"),
    [
        (1e-7, 0.0, True),
        (1e-7, 0.09, True),
        (1e-7, 0.11, False),  # it comes nearer by a tenth
        (1.01e-6, 0.0, False),  # where they are not that nearly singular
        (0.99e-6, 0.0, True),
    ],
)
def test_flows_on_nearly_singular_fields_are_refused_if_of_no_use(x, share, refused):
    """Of two fields one nearly vanishes where the path ends."""
    system = StratifiedSystem("x y", {"0": {"f": ["x", 0], "g": [0, 1]}}, "0")
    extended, ends = extend(system, ["f", "g"]), np.array([[1.0, 0.0], [x, 0.0]])
    flows = [Flow("0", "f", float(np.log1p(-share * (1 - x))))]
    if refused:
        left = f"{100 * (1 - share):.3g} % of its way: the elements are nearly singular"
        with pytest.raises(PlannerError, match=rf"misses {left} at \({x:g}, 0\)"):
            require_use(extended, ends, flows)
    else:
        require_use(extended, ends, flows)
    require_use(extended, ends[[1, 1]], [])  # no way at all


def test_the_part_of_a_velocity_that_is_missed_midway():
    """Between nodes, where inputs and samples are polynomials through their values."""
    system = StratifiedSystem("x y", {"0": {"f": ["1 + x", 0], "g": [0, 1]}}, "0")
    extended, nodes = extend(system, ["f", "g"]), collocation(5).nodes
    path = Path(lambda s: np.stack([s**2, np.sin(3 * s)], axis=1))
    samples = path.at(nodes)[None]
    inputs = fictitious_inputs_along(extended, samples)
    found = nominal._missed(extended, samples, inputs)
    assert found.shape == (1, 4)
    x, v = (np.polynomial.Polynomial.fit(nodes, values, 4, domain=[0, 1]) for values in
            (samples[0, :, 0], inputs[0, :, 0]))  # fmt: skip
    w = np.polynomial.Polynomial.fit(nodes, inputs[0, :, 1], 4, domain=[0, 1])
    y = np.polynomial.Polynomial.fit(nodes, samples[0, :, 1], 4, domain=[0, 1])
    middle = (nodes[1:] + nodes[:-1]) / 2
    given = np.array([(1 + x(middle)) * v(middle), w(middle)])
    missed = np.abs(given - [x.deriv()(middle), y.deriv()(middle)])
    size = np.abs(given).max(axis=1)[:, None]
    assert found[0] == pytest.approx((missed / size).max(axis=0), abs=1e-9)
    assert found.max() > 1e-6
