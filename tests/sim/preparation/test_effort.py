"""Walks that are too long are refused before they are walked."""

import pytest

from sim.errors import UsageError
from sim.folder import RunFolder
from sim.planning.open_loop import plan_open_loop
from sim.preparation import scheduling
from sim.preparation.scheduling import check_distance, check_effort
from sim.preparation.setup import prepare
from sim.run_folder import run
from sim.scenarios.body_path import line
from sim.walking.walks import Walker, carry_out, expected_steps

MOST_STEPS = 1_000_000_000  # of physics: eight hours at 35,000 a second


@pytest.mark.parametrize(
    ("changes", "remedy"),
    [
        ({"swing_speed": 1e-8}, "raise swing_speed, now 1e-08"),
        (
            {"swing_acceleration": 1e-9, "timestep": 1e-4},
            "raise swing_acceleration, now 1e-09",
        ),
        ({"timestep": 1e-6, "hold": 59, "swing_speed": 1e-3}, "raise timestep, now 1"),
    ],
)
@pytest.mark.parametrize("replan", [False, True])
def test_billions_of_steps_are_refused_with_a_setting_before_the_first(
    tmp_path, scenario, changes, remedy, replan
):
    folder = RunFolder(tmp_path / "walk")
    folder.path.mkdir()
    with pytest.raises(UsageError, match=r"^\d+(,\d+){3,} physics steps") as refusal:
        run(scenario(replan=replan, **changes), folder)
    assert refusal.value.remedy.startswith(remedy)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("replan", [False, True])
def test_steps_are_counted_before_the_walk(scenario, replan):
    setup = prepare(scenario(replan=replan))
    planned = None if replan else plan_open_loop(setup)
    counted, made = (
        expected_steps(setup, planned),
        carry_out(Walker(setup), planned).recording.steps,
    )
    # a replanned walk is taken for so many times its first segment
    assert counted == pytest.approx(made, rel=0.2 if replan else 0)


def test_rows_that_no_memory_holds_are_refused(scenario, monkeypatch):
    setup = prepare(scenario(sample_every=1))
    monkeypatch.setattr(scheduling, "_memory", lambda: 10**9)
    check_effort(setup, 100_000)
    with pytest.raises(UsageError, match="GB of memory") as refusal:
        check_effort(setup, 10_000_000)
    assert refusal.value.remedy.startswith("raise sample_every above ")
    every = int(refusal.value.remedy.split()[-1]) + 1
    check_effort(prepare(scenario(sample_every=every)), 10_000_000)


def test_a_long_walk_of_few_rows_is_walked(scenario):
    check_effort(prepare(scenario(sample_every=100_000)), MOST_STEPS)


def test_a_path_that_no_walk_follows_is_refused_before_planning(scenario, tmp_path):
    far = scenario(segments=100_000, path=line((1e6, 0.0, 0.0)), plan_time=1e-6)
    with pytest.raises(UsageError, match=r"path of 1e\+06 m takes .* rad of strokes"):
        run(far, RunFolder(tmp_path))
    check_distance(prepare(scenario(path=line((100.0, 0.0, 0.0)))))


def test_turning_without_end_is_refused_before_planning(scenario, tmp_path):
    round_and_round = scenario(path=line((0.0, 0.0, 1e6)), plan_time=1e-6)
    with pytest.raises(UsageError, match=r"path of 1e\+06 rad takes .* rad of strokes"):
        run(round_and_round, RunFolder(tmp_path))
    check_distance(prepare(scenario(path=line((0.0, 0.0, 100.0)))))
