"""How long a robot is looked at as it stands, and at which timesteps."""

from types import SimpleNamespace

import pytest

from models.errors import ModelError
from sim.errors import UsageError
from sim.physics import standing


@pytest.mark.parametrize(
    ("timestep", "steps"), [(0.001, 500), (0.005, 100), (0.0001, 4000), (0.00001, 4000)]
)
def test_a_robot_stands_for_half_a_second_but_for_four_thousand_steps_at_most(
    timestep, steps, monkeypatch
):
    done = []
    data = SimpleNamespace(qpos=[0.0, 0.0, 0.3], warning=[SimpleNamespace(number=1)])
    nothing = lambda *_: ()  # noqa: E731
    looks = SimpleNamespace(weightless=nothing, lying=nothing)
    engine = SimpleNamespace(
        MjData=lambda model: data,
        mj_resetDataKeyframe=nothing,
        mj_forward=nothing,
        mj_step=lambda model, data, nstep: done.append(nstep),
    )
    monkeypatch.setattr(standing, "mujoco", engine)
    monkeypatch.setattr(standing, "_refuse_obstacles", nothing)
    monkeypatch.setattr(standing, "_Standing", lambda *_: looks)
    robot = SimpleNamespace(root_address_in=lambda model: 0)
    model = SimpleNamespace(
        key=lambda name: SimpleNamespace(id=0), opt=SimpleNamespace(timestep=timestep)
    )
    standing._check_standing(SimpleNamespace(robot=robot), model, 0.1)
    assert sum(done) == steps
    assert set(done) == {10}  # between two looks at whether Ctrl-C was pressed


@pytest.mark.parametrize("enough", [0.002, 0.001, 0.0005])
def test_two_one_and_half_a_millisecond_are_tried_where_a_longer_step_fails(
    enough, monkeypatch
):
    def stands(kinematics, timestep, lift):
        if timestep > enough:
            raise ModelError("it falls")

    monkeypatch.setattr(standing, "_check_standing", stands)
    monkeypatch.setattr(standing, "with_timestep", lambda model, timestep: timestep)
    kinematics = SimpleNamespace(robot="it")
    model = SimpleNamespace(opt=SimpleNamespace(timestep=0.01))
    with pytest.raises(UsageError, match=f"give at most {enough:g}, at which"):
        standing._blame_the_timestep(kinematics, model, 0.1, ModelError("it falls"))
