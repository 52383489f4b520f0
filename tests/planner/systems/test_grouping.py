"""Regrouping by stratum: fewest switches, and only what commutes changes places."""

from itertools import permutations

import numpy as np
import pytest

from planner.errors import StratumError
from planner.extension.extended import extend
from planner.planning.rollouts import play
from planner.systems.flows import Flow, Word, contact_switches
from planner.systems.grouping import Grouper, regroup
from planner.systems.strata import StratifiedSystem
from tests.systems import LIFTED, PAPER, hexapod

ROUNDING = 1e-13
RNG = np.random.default_rng(5)


def random_word(length):
    names = RNG.choice(LIFTED[:4], length).tolist()
    return list(zip(names, RNG.uniform(-1, 1, length).tolist(), strict=True))


def in_order(extended, word, order=None):
    stratum_of = extended.system.stratum_of
    spelled = word if order is None else [word[i] for i in order]
    return [Flow(stratum_of[name], name, t) for name, t in spelled]


def regrouped(grouper, segments, ends=("12", "12")):
    ways = [
        [Word(tuple(name for name, _ in way), [t for _, t in way]) for way in segment]
        for segment in segments
    ]
    return regroup(grouper, ways, *ends)


def grouped(extended, *ways):
    (flows,) = regrouped(extended.grouper, [ways])
    return flows


@pytest.mark.parametrize("trial", range(5))
def test_regrouping_does_not_move_the_end(trial):
    extended = extend(hexapod(), LIFTED)
    word = random_word(12)
    x = RNG.uniform(-1, 1, 5)
    end = play(extended.system, grouped(extended, word), x)[-1]
    as_given = play(extended.system, in_order(extended, word), x)[-1]
    assert end == pytest.approx(as_given, abs=ROUNDING)


@pytest.mark.parametrize("trial", range(5))
def test_no_admissible_order_has_fewer_switches(trial):
    extended = extend(hexapod(), LIFTED)
    word = random_word(6)
    clash = [
        (i, j)
        for i in range(6)
        for j in range(i + 1, 6)
        if not extended.grouper.commute(word[i][0], word[j][0])
    ]
    fewest = min(
        contact_switches(extended.system, in_order(extended, word, order))
        for order in permutations(range(6))
        if all(order.index(i) < order.index(j) for i, j in clash)
    )
    assert contact_switches(extended.system, grouped(extended, word)) == fewest


def test_flows_that_do_not_commute_keep_their_order():
    extended = extend(hexapod(), LIFTED)
    word = [("g1_1", 1.0), ("g2_2", 1.0), ("g1_1", -1.0)]
    assert grouped(extended, word) == in_order(extended, word)


def test_flows_of_one_field_join_across_flows_that_commute():
    extended = extend(hexapod(), LIFTED)
    word = [("g1_1", 1.0), ("g1_2", 2.0), ("g1_1", 3.0)]
    joined = {Flow("1", "g1_1", 4.0), Flow("1", "g1_2", 2.0)}
    assert set(grouped(extended, word)) == joined


def test_the_way_with_fewest_switches_is_taken():
    extended = extend(hexapod(), LIFTED)
    long = [("g1_1", 1.0), ("g2_2", 1.0), ("g1_1", 1.0)]
    short = [("g2_2", 1.0), ("g1_1", 1.0)]
    assert grouped(extended, long, short) == in_order(extended, short)


def test_segments_are_arranged_with_their_neighbours_in_mind():
    # ending the first segment on S2 saves a change of stratum
    extended = extend(hexapod(), PAPER)
    first, second = [("g2_1", 1.0), ("g1_2", 1.0)], [("g2_1", 1.0)]
    ordered = regrouped(extended.grouper, [[first], [second]])
    assert [flow.stratum for flows in ordered for flow in flows] == ["1", "2", "2"]


def test_segments_without_flows_change_nothing():
    grouper = Grouper(hexapod(), lambda a, b: True)
    assert regrouped(grouper, [[[]], [[]]]) == [[], []]


def test_strata_that_nothing_joins_are_named():
    strata = {s: {f"g{s}": [1]} for s in ("1", "2")}
    apart = StratifiedSystem("x", strata, "1")
    grouper = Grouper(apart, lambda a, b: False)
    with pytest.raises(StratumError, match="joins S1 to S2"):
        regrouped(grouper, [[[("g2", 1.0)]]], ("1", "1"))


@pytest.mark.timeout(10)
def test_many_feet_are_arranged_without_trying_all_subsets():
    # 2^14 subsets of strata, each with one foot in the air, were half a minute
    feet = "abcdefghijklmn"
    raised = [feet.replace(foot, "") for foot in feet]
    strata = {feet: {}} | {name: {f"f_{name}": [1, 0]} for name in raised}
    system = StratifiedSystem("x y", strata, feet)
    found = Grouper(system, lambda a, b: True).arrangements(tuple(system.fields), feet)
    # the first foot lifts, and each time one lands another lifts
    assert {arrangement.switches for arrangement in found} == {1 + 2 * 13}
    assert {arrangement.end for arrangement in found} == set(raised)


def fewest_to_each_end(grouper, pattern, start):
    """Fewest switches to each stratum that an admissible order ends in."""
    system, places = grouper.system, range(len(pattern))
    fewest = {}
    for order in permutations(places):
        kept = all(
            order.index(i) < order.index(j)
            or pattern[i] == pattern[j]
            or grouper.commute(pattern[i], pattern[j])
            for j in places
            for i in range(j)
        )
        if kept:
            walk = [start, *(system.stratum_of[pattern[i]] for i in order)]
            cost = sum(map(system.switches, walk, walk[1:]))
            fewest[walk[-1]] = min(cost, fewest.get(walk[-1], cost))
    return fewest


def of_one_field_each(*strata):
    return StratifiedSystem("x y", {s: {f"f{s}": [1, 0]} for s in strata}, strata[0])


@pytest.mark.parametrize("trial", range(8))
def test_every_end_is_reached_as_cheaply_as_by_any_order(trial):
    rng = np.random.default_rng(trial)
    system = of_one_field_each("123", "12", "13", "23", "1")
    pattern = tuple(rng.choice(list(system.fields), 6).tolist())
    clash = {frozenset(rng.choice(list(system.fields), 2).tolist()) for _ in range(4)}
    grouper = Grouper(system, lambda a, b: frozenset((a, b)) not in clash)
    fewest = fewest_to_each_end(grouper, pattern, "123")
    found = {a.end: a.switches for a in grouper.arrangements(pattern, "123")}
    best = min(found, key=found.__getitem__)
    for end, cost in fewest.items():
        going_on = found[best] + system.switches(best, end)
        assert min(found.get(end, going_on), going_on) <= cost
    assert all(fewest[end] <= cost for end, cost in found.items())


def test_detours_through_shared_strata_do_not_mislead_the_search():
    # a bound on what is left that is ever too high takes 10 switches to one of the ends
    system = of_one_field_each("123", "1", "2", "3", "13")
    grouper = Grouper(system, lambda a, b: True)
    pattern = ("f3", "f2", "f1")
    found = {a.end: a.switches for a in grouper.arrangements(pattern, "123")}
    assert found == fewest_to_each_end(grouper, pattern, "123")


@pytest.mark.parametrize("goal", ["1", "2"])
def test_the_way_to_the_stratum_at_rest_counts_too(goal):
    """Either order switches alike up to its last flow; one of them ends at the goal."""
    extended = extend(hexapod(), PAPER)
    word = [("g2_1", 1.0), ("g1_2", 1.0)]
    (flows,) = regrouped(extended.grouper, [[word]], ("12", goal))
    assert flows[-1].stratum == goal
