"""What walks share is what each of them would have made by itself, to the last bit."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from sim.planning.open_loop import plan_open_loop
from sim.planning.sharing import is_shareable
from sim.preparation.setup import prepare
from sim.preparation.shared import (
    OF_THE_PHYSICS,
    OF_THE_WAY,
    OF_THE_WORLD,
    WITHOUT_EFFECT,
    Shared,
    everything_but,
)
from sim.scenarios.body_path import line
from sim.scenarios.scenario import Scenario, settings
from sim.simulation import simulate
from sim.world.model import build

COUNTED = ("servo", "resolution")  # with which servos have counts
LESS = ("identified", "creep_floor")
OTHER = {
    "name": "other", "description": "other", "stance": "paper", "words": "shortest",
    "segments": 3, "replan": True, "steer": "quasi-static", "optimise": "time",
    "path_tolerance": 0.1, "yaw_tolerance": 0.1, "together": True, "correct": 2,
    "friction": 0.7, "timestep": 0.0008, "servo": "mg90", "servo_stiffness": 432.198765,
    "servo_damping": 3.21987654, "command_rate": 200.0, "resolution": 0.001,
    "feed_forward": True, "zero_offset": 0.01, "play": 0.001,
    "payload": (0.1, 0.01, 0.0, 0.02), "slope": (0.01, 1.0), "floor_stiffness": 2e4,
    "foot_friction": (0.5, 0.6, 0.7, 0.8, 0.9, 1.0), "draw": 3, "swing_speed": 0.7,
    "swing_acceleration": 7.0, "lift_height": 0.02, "hold": 0.3, "plan_time": 100.0,
    "min_margin": 0.01, "min_clearance": 0.01, "allow_unstable": True,
    "sample_every": 7, "playback": 2.0, "seed": 4, "path": line((0.02, 0.0, 0.0)),
}  # fmt: skip
"""Another value of every setting that is said not to matter somewhere."""


@pytest.fixture(scope="module")
def plain():
    return Scenario(name="plain", segments=2, path=line((0.01, 0.01, 0.0)))


def changed(scenario, name):
    other = replace(scenario, **{name: OTHER[name]})
    assert other != scenario
    return other


@pytest.mark.parametrize("name", OF_THE_WAY)
def test_the_way_does_not_change_the_world(plain, hexapod, name):
    world, other = build(hexapod, plain), build(hexapod, changed(plain, name))
    assert world == other


@pytest.mark.parametrize("name", [n for n in OF_THE_PHYSICS if n not in COUNTED])
def test_the_physics_does_not_change_a_shareable_plan(plain, hexapod, name):
    setup, other = prepare(plain, hexapod), prepare(changed(plain, name), hexapod)
    assert is_shareable(other)
    assert plan_open_loop(setup).flows == plan_open_loop(other).flows


@pytest.mark.parametrize("name", COUNTED)
def test_plans_whose_strokes_end_on_counts_are_not_shared(plain, hexapod, name):
    setup, other = prepare(plain, hexapod), prepare(changed(plain, name), hexapod)
    assert not is_shareable(other)
    assert plan_open_loop(setup).flows != plan_open_loop(other).flows


def test_only_settings_that_exist_are_listed():
    known = {item.name for item in settings()} | {"path", "obstacles"}
    assert known >= {*OF_THE_WAY, *OF_THE_WORLD, *OF_THE_PHYSICS, *WITHOUT_EFFECT}


@pytest.mark.parametrize(
    "names",
    [
        ("friction",),
        ("servo_stiffness",),
        ("servo_damping",),
        ("friction", "servo_stiffness", "servo_damping"),
        ("payload",),
        ("foot_friction",),
        ("payload", "foot_friction", "friction", "servo_stiffness"),
    ],
)
def test_a_tuned_model_is_the_one_that_would_be_compiled(plain, hexapod, names):
    shared, tuned = Shared(), plain
    shared.world(plain, hexapod)
    for name in names:
        tuned = changed(tuned, name)
    world, model = shared.world(tuned, hexapod)
    alone = prepare(tuned, hexapod)
    assert world.servo == alone.world.servo
    for name in dir(model):
        value = getattr(model, name)
        if isinstance(value, np.ndarray):
            assert np.array_equal(value, getattr(alone.model, name)), name
    assert isinstance(model, mujoco.MjModel)


def test_things_are_made_once_and_the_oldest_are_forgotten():
    shared, made = Shared(), []
    for number in (1, 2, 1, *range(2, 40), 1):
        shared.kept("kind", number, lambda number=number: made.append(number))
    assert made == [1, 2, *range(3, 40), 1]


def test_settings_that_matter_tell_scenarios_apart(plain):
    other = changed(plain, "friction")
    assert everything_but(plain, ()) != everything_but(other, ())
    assert everything_but(plain, ["friction"]) == everything_but(other, ["friction"])


@pytest.mark.physics
def test_a_walk_that_shares_has_the_numbers_of_one_that_does_not(plain):
    shared = Shared()
    short = replace(plain, segments=1, swing_speed=1.0, timestep=0.001)
    first = replace(short, path=line((0.004, 0.004, 0.0)))
    points = [
        (first, ()),
        (changed(first, "servo_stiffness"), LESS),
        (replace(first, swing_speed=1.5), ()),  # in the same world, identified anew
        (replace(first, path=line((0.005, 0.004, 0.0))), ()),  # measured before
        (changed(first, "friction"), LESS),  # with the predictions of the first
        (changed(changed(first, "payload"), "foot_friction"), LESS),
        (replace(first, fields="paper"), LESS),
        (changed(replace(first, fields="paper"), "friction"), LESS),
    ]
    for point, without in points:
        done = simulate(point, shared=shared, without=without).summary
        alone = simulate(point, without=without).summary
        assert done | {"timing": 0} == alone | {"timing": 0}
