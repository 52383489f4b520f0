"""Centring by recoveries: the same motion of the body, legs in the middle."""

import numpy as np
import pytest

from planner.errors import RangeError
from planner.execution import centring
from planner.execution.execution import Execution
from planner.extension.extended import extend
from planner.planning.algorithm import plan
from planner.planning.paths import ellipse, line
from planner.planning.rollouts import rollout
from planner.systems.flows import Flow, contact_switches, merged, visits
from planner.systems.shape import ShapeCoordinates
from planner.systems.strata import StratifiedSystem
from tests.systems import LIFTED, METRES, PAPER, chained, hexapod

ROUNDING = 1e-12
AT_REST = np.zeros(5)
WAYS = {
    "line": (line(AT_REST, [0.15, 0.15, 0, 0, 0]), 40),
    "ellipse": (ellipse(AT_REST, (0.10, 0.06)), 60),
    "diagonal": (line(AT_REST, [0.15, 0.15, np.pi / 2, 0, 0]), 30),
}


@pytest.fixture(scope="module")
def robot():
    return extend(hexapod(**METRES), LIFTED)


def both(extended, way, **options):
    path, segments = WAYS[way]
    return [
        plan(extended, path, segments, execution=Execution(stance=stance, **options))
        for stance in ("paper", "centred")
    ]


def largest_angle(extended, planned):
    courses = [extended.shape.trajectory(i, planned.flows, 0.0) for i in (3, 4)]
    return np.abs(courses).max()


def test_swings_of_a_tripod_in_the_air_are_free_and_those_under_load_are_not():
    assert ShapeCoordinates(hexapod()).recoveries == {"g1_2": (4, 1), "g2_1": (3, 1)}


def test_lifts_are_not_free():
    assert set(ShapeCoordinates(hexapod(heights=True)).recoveries) == {"g1_2", "g2_1"}


def test_coordinate_that_a_field_depends_on_is_not_free():
    assert ShapeCoordinates(chained(3)).recoveries == {}


@pytest.mark.parametrize("way", WAYS)
def test_centring_does_not_move_the_end_of_the_body(robot, way):
    paper, centred = (rollout(p)[-1] for p in both(robot, way))
    assert centred == pytest.approx(paper, abs=ROUNDING)


@pytest.mark.parametrize("way", WAYS)
def test_centring_costs_four_contact_events_a_plan(robot, way):
    paper, centred = both(robot, way)
    assert centred.contact_switches == paper.contact_switches + 4


@pytest.mark.parametrize("way", WAYS)
def test_every_sweep_under_load_is_centred_on_zero(robot, way):
    _, centred = both(robot, way)
    angles = {"1": 0.0, "2": 0.0}
    for visit in visits(merged(centred.flows)):
        stratum = visit[0].stratum
        (sweep,) = [f for f in visit if f.field in LIFTED[:2]] or [None]
        for flow in visit:
            leg = flow.field[-1]
            before = angles[leg]
            angles[leg] += flow.duration
            if flow is sweep:
                assert leg == stratum
                assert before + angles[leg] == pytest.approx(0, abs=ROUNDING)


@pytest.mark.parametrize(
    ("way", "paper_angle", "centred_angle"),
    [("line", 0.30, 0.18), ("ellipse", 0.39, 0.22), ("diagonal", 0.34, 0.22)],
)
def test_largest_angles_are_those_of_the_design(robot, way, paper_angle, centred_angle):
    paper, centred = both(robot, way, coordinates="backward")
    assert largest_angle(robot, paper) == pytest.approx(paper_angle, abs=0.006)
    assert largest_angle(robot, centred) == pytest.approx(centred_angle, abs=0.006)


@pytest.mark.parametrize(
    ("way", "coordinates", "switches"),
    [
        ("line", "backward", 322),
        ("line", "fewest", 322),
        ("ellipse", "backward", 594),
        ("ellipse", "fewest", 482),  # 8 a segment and 2, as if no bracket were negative
        ("diagonal", "fewest", 242),
    ],
)
def test_contact_switches_of_the_grouped_plans(robot, way, coordinates, switches):
    paper, _ = both(robot, way, coordinates=coordinates)
    assert paper.contact_switches == switches


def test_legs_end_where_the_goal_has_them_and_stay_if_told_so(robot):
    goal = np.array([0.03, 0.02, 0, 0.1, -0.1])
    home, away = (
        plan(
            robot,
            line(AT_REST, goal),
            3,
            execution=Execution(stance="centred", finish=finish),
        )
        for finish in (True, False)
    )
    assert rollout(home)[-1][3:] == pytest.approx(goal[3:], abs=ROUNDING)
    assert np.abs(rollout(away)[-1][3:] - goal[3:]).min() > 1e-3
    assert rollout(away)[-1][:3] == pytest.approx(rollout(home)[-1][:3], abs=ROUNDING)


def test_start_shape_is_arbitrary(robot):
    start = np.array([0, 0, 0, 0.3, -0.4])
    planned = plan(
        robot,
        line(start, AT_REST + [0.02, 0, 0, 0, 0]),
        2,
        execution=Execution(stance="centred"),
    )
    loaded = [f for f in planned.flows if f.field in LIFTED[:2]]
    assert max(abs(f.duration) for f in loaded) / 2 < 0.3
    assert rollout(planned)[-1][3:] == pytest.approx([0, 0], abs=ROUNDING)


def test_printed_fields_can_be_centred_too():
    extended = extend(hexapod(**METRES), PAPER)
    paper, centred = both(extended, "line")
    assert rollout(centred)[-1] == pytest.approx(rollout(paper)[-1], abs=ROUNDING)
    assert largest_angle(extended, centred) < largest_angle(extended, paper)


def test_course_of_a_leg_is_that_of_the_rollout(robot):
    _, centred = both(robot, "line")
    assert robot.shape.trajectory(3, centred.flows, 0.0) == pytest.approx(
        rollout(centred)[:, 3], abs=ROUNDING
    )


def test_range_that_would_be_left_is_refused_with_the_number_of_segments_that_do(robot):
    path, limits = WAYS["line"][0], {"phi_1": (-0.2, 0.2), "phi_2": (-0.2, 0.2)}
    with pytest.raises(
        RangeError, match="outside its range -0.2 to 0.2; plan at"
    ) as no:
        plan(robot, path, 4, execution=Execution(stance="centred", limits=limits))
    enough = plan(
        robot,
        path,
        no.value.segments,
        execution=Execution(stance="centred", limits=limits),
    )
    assert largest_angle(robot, enough) <= 0.2
    with pytest.raises(RangeError):
        plan(
            robot,
            path,
            no.value.segments - 1,
            execution=Execution(stance="centred", limits=limits),
        )


def test_range_that_no_number_of_segments_keeps_is_refused(robot):
    with pytest.raises(RangeError, match="no number of segments suffices") as refusal:
        plan(
            robot,
            line([0, 0, 0, 0.5, 0], AT_REST),
            1,
            execution=Execution(limits={"phi_1": (-0.2, 0.2)}),
        )
    assert refusal.value.segments is None


def test_range_that_needs_more_segments_than_are_tried_is_not_called_hopeless(
    robot, monkeypatch
):
    monkeypatch.setattr("planner.planning.algorithm.MOST_TRIED", 8)
    limits = {"phi_1": (-1e-3, 1e-3)}
    with pytest.raises(
        RangeError, match="; 8 segments do not suffice; widen the range"
    ):
        plan(robot, WAYS["line"][0], 1, execution=Execution(limits=limits))


def test_words_that_keep_the_range_are_preferred_to_fewer_switches(robot):
    path, segments = WAYS["diagonal"]
    limits = {"phi_1": (-0.4, 0.4), "phi_2": (-0.4, 0.4)}
    free, bound = (
        plan(robot, path, segments, execution=Execution(limits=held))
        for held in ({}, limits)
    )
    assert largest_angle(robot, free) > 0.4 >= largest_angle(robot, bound)
    assert free.contact_switches < bound.contact_switches


@pytest.mark.parametrize(
    ("limits", "message"),
    [
        ({"phi_3": (-1, 1)}, "limit of phi_3, which is unknown; did you mean 'phi_"),
        ({"phi_1": (1, -1)}, "limits of phi_1 are empty: 1 to -1"),
        ({"x": (-1, 1)}, "limit of x: some field moves it at a rate that varies"),
    ],
)
def test_limits_that_bound_no_shape_are_refused(robot, limits, message):
    with pytest.raises(ValueError, match=message):
        plan(
            robot,
            line(AT_REST, [0.01, 0, 0, 0, 0]),
            1,
            execution=Execution(limits=limits),
        )


@pytest.mark.parametrize("stance", ["centred", "stepped"])
def test_fields_known_as_functions_have_no_known_shape(stance):
    strata = {"12": {}, "1": {"a": [1, 0]}, "2": {"b": lambda x: [0, 1]}}
    mixed = StratifiedSystem("x y", strata, "12")
    straight = line([0, 0], [1, 1])
    planned = plan(mixed, straight, 2, ["a", "b"], execution=Execution(stance=stance))
    assert rollout(planned)[-1] == pytest.approx([1, 1], abs=ROUNDING)
    with pytest.raises(
        ValueError, match="limit of x: .* known as a function only; limit"
    ):
        plan(mixed, straight, 2, ["a", "b"], execution=Execution(limits={"x": (-1, 1)}))


def test_switches_of_centred_plans_are_those_of_their_flows(robot):
    _, centred = both(robot, "line")
    assert (
        contact_switches(robot.system, centred.flows) == centred.contact_switches == 326
    )


def one_leg():
    """Two fields under load that sweep the leg apart, and its swing in the air."""
    return StratifiedSystem(
        "x y p",
        {
            "12": {"push": [1, 0, 1], "pull": [0, 1, -2]},
            "1": {"swing": [0, 0, 1], "slide": [1, 1, 0]},
            "2": {"drag": [2, 1, 0]},
        },
        "12",
    )


def centred_leg(*segments, goal=None):
    shape = ShapeCoordinates(one_leg())
    given = [[Flow(shape.system.stratum_of[f], f, t) for f, t in s] for s in segments]
    end = None if goal is None else np.array([0, 0, goal])
    found = centring.centred(shape, given, np.zeros(3), end, ("12", "12"))
    return [[(flow.field, flow.duration) for flow in flows] for flows in found]


def test_it_is_the_reach_of_a_sweep_that_is_centred_and_not_its_net():
    """The leg goes 0.4 forward and 0.6 back, from 0.4 to -0.2 of where it starts."""
    (flows,) = centred_leg([("push", 0.4), ("pull", 0.3)])
    assert flows[0] == ("swing", pytest.approx(-0.1, abs=ROUNDING))
    assert flows[1:] == [("push", 0.4), ("pull", 0.3)]


def test_a_leg_is_set_in_the_last_stay_in_the_air_before_it_is_loaded():
    """Set earlier, it would be held there for longer than it need be."""
    first, second, third = centred_leg(
        [("push", 0.2), ("slide", 1.0)],
        [("drag", 1.0)],
        [("slide", 1.0), ("push", 0.4)],
    )
    names = [[field for field, _ in flows] for flows in (first, second, third)]
    assert names == [["swing", "push", "slide"], ["drag"], ["swing", "slide", "push"]]
    assert third[0][1] == pytest.approx(-0.3, abs=ROUNDING)


def test_legs_end_at_the_goal_from_wherever_the_last_sweep_leaves_them():
    """It leaves them at 0.2, the opposite of where they are to be."""
    (flows,) = centred_leg([("push", 0.4)], goal=-0.2)
    assert flows[-1] == ("swing", pytest.approx(-0.4, abs=ROUNDING))


def test_legs_are_brought_to_the_goal_of_a_plan_without_flows_too():
    assert centred_leg([], goal=0.3) == [[("swing", pytest.approx(0.3, abs=ROUNDING))]]


def test_a_leg_may_go_up_to_the_end_of_its_range():
    shape, sweep = ShapeCoordinates(one_leg()), [Flow("12", "push", 0.4)]
    shape.require_within({"p": (-0.1, 0.4)}, sweep, np.zeros(3))
    with pytest.raises(RangeError):
        shape.require_within({"p": (-0.1, 0.399)}, sweep, np.zeros(3))
