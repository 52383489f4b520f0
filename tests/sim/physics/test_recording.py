"""The recorder: the same whatever the pieces that commands come in."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, strategies as st

from sim.physics.engine import State
from sim.physics.measure import Readings, bridge, count_bounces
from sim.physics.recording import Recorder

DT = 0.005  # four steps make an interruption


class Engine:
    """An engine that knows its forces and speeds ahead."""

    def __init__(self, loaded):
        self.model = SimpleNamespace(opt=SimpleNamespace(timestep=DT), nsensor=0)
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
            qpos=after, qvel=after * 0, sensordata=self.loaded[begin:end].astype(float)
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
    assert recording.bounces == count_bounces(loaded, contact)
    seen = recording.contacts.between(2, last)
    assert {tuple(row) for row in seen} == {tuple(row) for row in contact[2:]}
