"""What walks share is what each of them would have made by itself, to the last bit."""

from dataclasses import replace
from typing import Literal, get_args, get_origin

import pytest

from models import ModelError, load
from sim.planning.open_loop import plan_open_loop
from sim.preparation import setup
from sim.preparation.setup import prepare
from sim.preparation.shared import PLAN, WORLD, Shared
from sim.scenarios.body_path import line
from sim.scenarios.declaration import Range, options
from sim.scenarios.file import load_scenario
from sim.scenarios.scenario import Scenario
from sim.scenarios.settings import SETTINGS
from sim.simulation import simulate
from sim.world.model import build

LESS = ("identified", "compliant", "creep_floor")
STAND = ("compliant", "creep_floor")
OTHER = {
    "friction": 0.7, "servo": "mg90", "servo_stiffness": 432.198765,
    "servo_damping": 3.21987654, "command_rate": 200.0, "resolution": 0.001,
    "payload": (0.1, 0.01, 0.0, 0.02), "slope": (0.01, 1.0), "floor_stiffness": 2e4,
    "foot_friction": (0.5, 0.6, 0.7, 0.8, 0.9, 1.0), "timestep": 0.0008,
    "lift_height": 0.02, "zero_offset": 0.01, "backlash": 0.001, "dead_band": 0.001,
    "path": line((0.02, 0.0, 0.0)), "gait": ("12", "1", "12", "2", "12"),
    "predictions": ("quasi_static",), "learnt": (0.0,) * 90,
}  # fmt: skip
"""Values that a hexapod can walk with, where any other value of a setting cannot be."""
COUNTED = ("servo", "resolution")  # with which servos have counts


def another(name):
    """A value of a setting that is not its default, from what is declared about it."""
    if name in OTHER:
        return OTHER[name]
    declared = SETTINGS[name]
    kind = options(declared.kind)[0]
    if kind in (bool, str):
        return {bool: not declared.default, str: "other"}[kind]
    inner = get_args(kind)
    if get_origin(kind) is Literal:
        return next(word for word in inner if word != declared.default)
    if not isinstance(inner[1], Range):
        return "other"
    usual = declared.default or 0
    return inner[0](usual + (1 if inner[0] is int else 0.01 * (usual or 1)))


def unless(*effects):
    """Settings, and the path, that have none of some effects."""
    own = [name for name, item in SETTINGS.items() if not item.affects & {*effects}]
    return own if "plan" in effects else [*own, "path"]


@pytest.fixture(scope="module")
def plain():
    return Scenario(name="plain", segments=2, path=line((0.01, 0.01, 0.0)))


@pytest.fixture(scope="module")
def world(plain, hexapod):
    return build(hexapod, plain)


@pytest.fixture(scope="module")
def planned(plain, hexapod):
    """The flows of the plain scenario's plan."""
    return plan_open_loop(prepare(plain, hexapod)).flows


def changed(scenario, name):
    other = replace(scenario, **{name: another(name)})
    assert other != scenario
    return other


@pytest.mark.parametrize("name", unless(*WORLD))
def test_the_way_does_not_change_the_world(plain, world, hexapod, name):
    assert build(hexapod, changed(plain, name)) == world


@pytest.mark.parametrize("name", unless(*PLAN))
def test_the_physics_does_not_change_a_shareable_plan(plain, planned, hexapod, name):
    other = prepare(changed(plain, name), hexapod)
    assert other.is_shareable
    assert plan_open_loop(other).flows == planned


@pytest.mark.parametrize("name", COUNTED)
def test_plans_whose_strokes_end_on_counts_are_not_shared(
    plain, planned, hexapod, name
):
    other = prepare(changed(plain, name), hexapod)
    assert not other.is_shareable
    assert plan_open_loop(other).flows != planned


def test_scenarios_that_differ_in_the_way_share_a_model(plain, hexapod):
    shared = Shared()
    model = prepare(plain, hexapod, shared).model
    assert prepare(changed(plain, "path"), hexapod, shared).model is model
    assert prepare(changed(plain, "friction"), hexapod, shared).model is not model
    bumpy = changed(plain, "bumps")  # which lie along the way
    first, again = (prepare(bumpy, hexapod, shared).model for _ in range(2))
    assert first is not again


def test_whether_a_robot_stands_is_tried_once_a_world(plain, hexapod, monkeypatch):
    shared, tried = Shared(), []
    monkeypatch.setattr(setup, "check_standing", lambda *given: tried.append(given))
    for name in ("friction", "path", "bumps", "bumps"):  # bumps lie along the way
        prepare(changed(plain, name), hexapod, shared)
        prepare(plain, hexapod, shared)
    assert len(tried) == 4


def test_walks_that_lift_less_in_the_same_world_are_tried_anew(plain, hexapod):
    shared = Shared()
    prepare(plain, hexapod, shared)
    with pytest.raises(ModelError, match="a lifted foot rises by 0.0 mm only"):
        prepare(replace(plain, lift_height=1e-5), hexapod, shared)


def test_things_are_made_once_and_the_oldest_are_forgotten():
    shared, made = Shared(), []
    for number in (1, 2, 1, *range(2, 40), 1):
        shared.cached("kind", number, lambda number=number: made.append(number))
    assert made == [1, 2, *range(3, 40), 1]


def test_settings_that_matter_tell_scenarios_apart(plain):
    other = changed(plain, "friction")
    assert plain.key("world") != other.key("world")
    assert plain.key(*PLAN) == other.key(*PLAN)


@pytest.mark.physics
def test_a_walk_that_shares_has_the_numbers_of_one_that_does_not(plain):
    shared = Shared()
    short = replace(plain, segments=1, swing_speed=1.0, timestep=0.001, hold=0.1)
    first = replace(short, path=line((0.004, 0.004, 0.0)))
    points = [
        (first, ("compliant",)),
        (replace(first, swing_speed=1.5), STAND),  # in the same world, identified anew
        (
            replace(first, path=line((0.005, 0.004, 0.0))),
            ("compliant",),
        ),  # measured before
        (changed(first, "friction"), LESS),  # with the predictions of the first
        (replace(first, fields="paper"), LESS),
    ]
    for point, without in points:
        done = simulate(point, shared=shared, without=without).summary
        alone = simulate(point, without=without).summary
        assert replace(done, timing={}) == replace(alone, timing={})


@pytest.mark.physics
def test_a_robot_shares_nothing_with_another_of_its_name(plain, hexapod):
    shared = Shared()
    short = replace(plain, segments=1, swing_speed=1.0, timestep=0.001, hold=0.1)
    first, second = (group.legs for group in hexapod.card.groups.values())
    for robot in (hexapod, hexapod.alternating({"1": second, "2": first})):
        done = simulate(short, robot=robot, shared=shared, without=LESS)
        alone = simulate(short, robot=robot, without=LESS)
        assert done.plan.flows == alone.plan.flows
        assert replace(done.summary, timing={}) == replace(alone.summary, timing={})
        assert prepare(short, robot, shared).model is done.prepared.setup.model


def test_a_robot_shares_with_itself_loaded_again(plain):
    shared = Shared()
    first, again = (prepare(plain, load("hexapod"), shared) for _ in range(2))
    assert first.extended is again.extended
    assert first.model is again.model


@pytest.mark.physics
def test_a_walk_says_which_predictions_were_left_out():
    """So that its scenario, walked again, makes the same ones."""
    short = load_scenario("line", {"segments": 1, "path.goal": [0.004, 0.004, 0.0]})
    done = simulate(short, without=("identified", "compliant", "creep_floor"))
    asked = done.prepared.scenario.predictions
    assert asked == ("ideal", "quasi_static")
    again = simulate(replace(short, predictions=asked), without=("creep_floor",))
    assert again.summary.predicted.keys() == done.summary.predicted.keys()
    assert again.summary.weighed == done.summary.weighed
