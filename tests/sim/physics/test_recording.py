"""The recorder: the same whatever the pieces that commands come in."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, strategies as st

from sim.physics.engine import State
from sim.physics.measure import Readings, bridge, count_bounces
from sim.physics.recording import Recorder

DT = 0.005  # four steps make an interruption
NONE = np.zeros((0, 2))


class Engine:
    """An engine that knows its forces and speeds ahead."""

    def __init__(self, loaded):
        none = {"actuator_forcelimited": np.zeros(0), "actuator_forcerange": NONE}
        opt = SimpleNamespace(timestep=DT)
        self.model = SimpleNamespace(opt=opt, nsensor=0, nu=0, **none)
        self.loaded, self.steps = loaded, 0

    @property
    def state(self):
        """The number of steps for a position."""
        return State(np.array([float(self.steps)]), np.zeros(1))

    def advance(self, ctrl):
        """As the real one: states after, sensors before each step."""
        begin, end = self.steps, self.steps + len(ctrl)
        self.steps = end
        after = np.arange(begin + 1.0, end + 1.0)[:, None]
        return SimpleNamespace(
            qpos=after,
            qvel=after * 0,
            sensordata=self.loaded[begin:end].astype(float),
            actuator_force=np.zeros((len(ctrl), 0)),
        )

    def sense(self):
        """Sensors of the last state."""
        return self.loaded[self.steps].astype(float)


class Sensors:
    """Reads forces as they are; a foot slips by its number of metres a second."""

    feet = 2

    def read(self, force):
        """Everything but force and speed stands still."""
        speed = np.ones_like(force) * [1.0, 2.0]
        return Readings(
            force, speed, np.zeros((*force.shape, 2)), np.zeros((len(force), 3))
        )

    def loaded(self, readings):
        """Any force is load."""
        return readings.force > 0


def record(loaded, cuts, every, looks):
    recorder = Recorder(Engine(loaded), Sensors(), every)
    ctrl = np.zeros((len(loaded) - 1, 1))
    for _ in recorder.play(np.split(ctrl, cuts), looks):
        pass
    return recorder.finish()


FLAGS = st.lists(st.tuples(st.booleans(), st.booleans()), min_size=12, max_size=40)
CUTS = st.lists(st.integers(1, 10), max_size=4, unique=True).map(sorted)


@given(FLAGS, CUTS, st.integers(1, 9))
def test_contacts_slip_and_states_are_those_of_the_whole_run(flags, cuts, every):
    loaded = np.array(flags)
    contact = bridge(loaded, 4)
    recording = record(loaded, cuts, every, np.array([3, 7]))
    moments = recording.moments
    last = len(loaded) - 1
    wanted = {3, 7, last, *range(every, len(loaded), every)}
    assert moments.step.tolist() == sorted(wanted)
    assert np.array_equal(moments.qpos[:, 0], moments.step)
    assert moments.step[recording.marks.inspected].tolist() == sorted({3, 7, last})
    assert np.array_equal(moments.contact, contact[moments.step])
    slipped = np.cumsum(contact * [1.0, 2.0], axis=0) - contact * [1.0, 2.0]
    assert moments.slip == pytest.approx(DT * slipped[moments.step])
    assert np.array_equal(recording.bounces_of, count_bounces(loaded, contact))
    seen = recording.contacts.between(2, last)
    assert {tuple(row) for row in seen} == {tuple(row) for row in contact[2:]}


class Touch(Sensors):
    """Points are the forces, and 0 in the air, as of a sensor without a contact."""

    def read(self, force):
        """A foot touches at the number of its force."""
        point = np.repeat(force[..., None], 2, axis=-1)
        return replace(super().read(force), point=point)


@pytest.mark.parametrize("cuts", [[], [3], [7], [5, 8]])
def test_a_foot_keeps_the_point_it_last_touched_from_piece_to_piece(cuts):
    force = np.array([1, 2, 3, 4, 5, 0, 0, 0, 0, 0, 0, 0.0])[:, None] * [1.0, 10.0]
    recorder = Recorder(Engine(force), Touch(), 1)
    for _ in recorder.play(np.split(np.zeros((len(force) - 1, 1)), cuts)):
        pass
    kept = recorder.finish().moments.point[:, :, 0]
    assert kept[-6:].tolist() == [[5, 50]] * 6


def test_steps_are_counted_in_which_an_actuator_gave_all_its_force():
    """At either end of its range; one without a limit has none."""
    ranges = np.array([[-1.0, 2.0], [-1.0, 2.0], [-1.0, 2.0]])
    limits = {
        "actuator_forcelimited": np.array([1, 1, 0]),
        "actuator_forcerange": ranges,
    }
    recorder = SimpleNamespace(engine=SimpleNamespace(model=SimpleNamespace(**limits)))
    force = np.array(
        [[2.0, 1.99, 2.0], [-1.0, 0.0, -1.0], [2.0, 2.0, 2.0], [1.0, 1.0, 0]]
    )
    assert Recorder._at_limit(recorder, force).tolist() == [3, 1, 0]
