"""Regrouping by stratum: fewest switches, and only what commutes changes places."""

from itertools import permutations

import numpy as np
import pytest

from planner.errors import StratumError
from planner.extended import extend
from planner.flows import Flow, contact_switches
from planner.grouping import Grouper, regroup
from planner.rollout import play
from planner.strata import StratifiedSystem
from tests.systems import LIFTED, PAPER, hexapod

ROUNDING = 1e-13
RNG = np.random.default_rng(5)


def random_word(system, names, length):
    return [
        Flow(system.stratum_of[name], name, float(t))
        for name, t in zip(
            RNG.choice(names, length), RNG.uniform(-1, 1, length), strict=True
        )
    ]


def grouped(extended, *ways):
    (flows,) = regroup(extended.grouper, [ways], "12", "12")
    return flows


@pytest.mark.parametrize("trial", range(5))
def test_regrouping_does_not_move_the_end(trial):
    extended = extend(hexapod(), LIFTED)
    flows = random_word(extended.system, LIFTED[:4], 12)
    x = RNG.uniform(-1, 1, 5)
    end = play(extended.system, grouped(extended, flows), x)[-1]
    assert end == pytest.approx(play(extended.system, flows, x)[-1], abs=ROUNDING)


@pytest.mark.parametrize("trial", range(5))
def test_no_admissible_order_has_fewer_switches(trial):
    extended = extend(hexapod(), LIFTED)
    flows = random_word(extended.system, LIFTED[:4], 6)
    clash = [
        (i, j)
        for i in range(6)
        for j in range(i + 1, 6)
        if not extended.grouper.interchange(flows[i].field, flows[j].field)
    ]
    fewest = min(
        contact_switches(extended.system, [flows[i] for i in order])
        for order in permutations(range(6))
        if all(order.index(i) < order.index(j) for i, j in clash)
    )
    assert contact_switches(extended.system, grouped(extended, flows)) == fewest


def test_flows_that_do_not_commute_keep_their_order():
    extended = extend(hexapod(), LIFTED)
    flows = [Flow("1", "g1_1", 1.0), Flow("2", "g2_2", 1.0), Flow("1", "g1_1", -1.0)]
    assert grouped(extended, flows) == flows


def test_flows_of_one_field_join_across_flows_that_commute():
    extended = extend(hexapod(), LIFTED)
    flows = [Flow("1", n, t) for n, t in (("g1_1", 1.0), ("g1_2", 2.0), ("g1_1", 3.0))]
    assert sorted(grouped(extended, flows)) == [
        Flow("1", "g1_1", 4.0),
        Flow("1", "g1_2", 2.0),
    ]


def test_the_way_with_fewest_switches_is_taken():
    extended = extend(hexapod(), LIFTED)
    long = [Flow("1", "g1_1", 1.0), Flow("2", "g2_2", 1.0), Flow("1", "g1_1", 1.0)]
    short = [Flow("2", "g2_2", 1.0), Flow("1", "g1_1", 1.0)]
    assert grouped(extended, long, short) == short


def test_segments_are_arranged_with_their_neighbours_in_mind():
    # ending the first segment on S2 saves a change of stratum
    extended = extend(hexapod(), PAPER)
    first = [Flow("2", "g2_1", 1.0), Flow("1", "g1_2", 1.0)]
    second = [Flow("2", "g2_1", 1.0)]
    ordered = regroup(extended.grouper, [[first], [second]], "12", "12")
    assert [flow.stratum for flows in ordered for flow in flows] == ["1", "2", "2"]


def test_segments_without_flows_change_nothing():
    grouper = Grouper(hexapod(), lambda a, b: True)
    assert regroup(grouper, [[[]], [[]]], "12", "12") == [[], []]


def test_strata_that_nothing_joins_are_named():
    strata = {s: {f"g{s}": [1]} for s in ("1", "2")}
    apart = StratifiedSystem("x", strata, "1")
    grouper = Grouper(apart, lambda a, b: False)
    with pytest.raises(StratumError, match="joins S1 to S2"):
        regroup(grouper, [[[Flow("2", "g2", 1.0)]]], "1", "1")
