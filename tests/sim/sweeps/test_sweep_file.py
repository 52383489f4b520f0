"""A sweep's file becomes points, or is refused before anything is walked."""

import pytest

from sim.errors import UsageError
from sim.sweeps.file import flat, read_sweep
from sim.sweeps.folder import About, Shard
from sim.sweeps.sweeping import points_of
from tests.sweeps import write_sweep


def test_points_are_all_combinations_and_the_last_block_is_fastest(tmp_path):
    varies = """
[grid]
friction = [0.5, 1.0]
[list]
play = [0.0, 0.01, 0.02]
draw = [1, 2, 3]
"""
    sweep = read_sweep(str(write_sweep(tmp_path, varies)))
    assert len(sweep) == 6
    assert sweep.keys == ("friction", "play", "draw")
    assert sweep.varied(0) == {"friction": 0.5, "play": 0.0, "draw": 1}
    assert sweep.varied(1) == {"friction": 0.5, "play": 0.01, "draw": 2}
    assert sweep.varied(5) == {"friction": 1.0, "play": 0.02, "draw": 3}
    scenario = sweep.at(5)
    assert (scenario.friction, scenario.backlash, scenario.draw) == (1.0, 0.02, 3)
    assert scenario.segments == 1
    assert scenario.path.goal == (0.002, 0.002, 0.0)


def test_a_sweep_may_have_the_tables_of_a_scenario_itself(tmp_path):
    path = tmp_path / "own.toml"
    path.write_text(
        'robot = "octopod"\n[path]\nkind = "line"\ngoal = [0.1, 0, 0]\n'
        "[grid]\nfriction = [0.5, 1.0]\n"
    )
    scenario = read_sweep(str(path)).at(1)
    assert (scenario.robot, scenario.friction) == ("octopod", 1.0)


def test_a_sweep_may_play_a_motion_that_lies_beside_it(tmp_path):
    path = tmp_path / "own.toml"
    path.write_text('motion = "gait.csv"\n[grid]\nfriction = [0.5, 1.0]\n')
    (tmp_path / "gait.csv").write_text("time,lift_1\n0,0\n1,0\n")
    assert read_sweep(str(path)).at(1).motion == str(tmp_path / "gait.csv")


def test_a_shipped_scenario_is_meant_by_its_name_wherever_the_sweep_lies(tmp_path):
    (tmp_path / "line").write_text('motion = "gait.csv"\n')
    path = tmp_path / "own.toml"
    path.write_text('scenario = "line"\n[grid]\nfriction = [0.5, 1.0]\n')
    assert read_sweep(str(path)).at(1).motion is None


def test_a_path_leads_from_the_sweep_s_folder_whatever_the_file_is_called(tmp_path):
    (tmp_path / "line").write_text('[path]\nkind = "line"\ngoal = [0.1, 0, 0]\n')
    path = tmp_path / "own.toml"
    path.write_text('scenario = "./line"\n[grid]\nfriction = [0.5, 1.0]\n')
    assert read_sweep(str(path)).at(1).path.goal == (0.1, 0.0, 0.0)


def test_a_sweep_of_a_sweep_is_told_which_file_that_is(tmp_path):
    write_sweep(tmp_path, "[grid]\nfriction = [0.5, 1.0]")
    path = tmp_path / "twice.toml"
    path.write_text('scenario = "small.toml"\n[grid]\nfriction = [0.5, 1.0]\n')
    said = "a sweep and no scenario: .*small.toml; stratawalk sweep .*/small.toml"
    with pytest.raises(UsageError, match=said):
        read_sweep(str(path))


def test_a_robots_file_is_found_from_the_sweeps_folder(tmp_path):
    sweep = read_sweep(
        str(write_sweep(tmp_path, '[grid]\nrobot = ["hexapod", "mine.xml"]'))
    )
    assert sweep.varied(1) == {"robot": str(tmp_path / "mine.xml")}


@pytest.mark.parametrize(
    ("varies", "said"),
    [
        ("[grid]\nfriktion = [1]", "unknown key 'friktion'.*did you mean 'friction'"),
        ("[grid]\nfriction = [-1]", "friction = -1.*a number from 0 to 10"),
        ("[grid]\nplay = [0.01]\n[list]\nplay = [0.02]", "play is given twice"),
        ("[grid]\nhold = [0.2]", "hold is given twice"),
        ("[list]\ngeometry.d = [1]\n'geometry.d' = [2]", "geometry.d is given twice"),
        (
            "[sobol]\npoints = 2\ngeometry.d = [1, 2]\n'geometry.d' = [2, 3]",
            "geometry.d is given twice",
        ),
        ("[keep]\npoints = [1]", r"points = \[1\] is not allowed"),
        ("[keep]\npionts = [0]", "did you mean 'points'"),
        ("[gird]\nplay = [0.01]", "unknown key 'gird'.*did you mean 'grid'"),
    ],
)
def test_mistakes_are_refused_with_what_was_meant(tmp_path, varies, said):
    path = str(write_sweep(tmp_path, varies))
    with pytest.raises(UsageError, match=f"(?s){said}"):
        read_sweep(path).at(0)


def test_a_sequence_has_a_seed_of_its_own(tmp_path):
    own = "[grid]\nseed = [1, 2]\n[sobol]\nseed = 5\npoints = 2\nfriction = [0.5, 1]\n"
    sweep = read_sweep(str(write_sweep(tmp_path, own)))
    assert [sweep.at(point).seed for point in range(4)] == [1, 1, 2, 2]


def test_more_points_than_are_checked_in_seconds_are_refused(tmp_path):
    varies = "friction = {{ from = 0, to = 1, count = {} }}\ndraw = [1, 2]\n"
    path = str(write_sweep(tmp_path, "[grid]\n" + varies.format(25_000)))
    assert len(read_sweep(path)) == 50_000
    path = str(write_sweep(tmp_path, "[grid]\n" + varies.format(25_001)))
    with pytest.raises(UsageError, match="50002 points: .* at most 50000 points"):
        read_sweep(path)


def test_points_beyond_all_counting_are_refused_as_well(tmp_path):
    pairs = "".join(f"a{number} = [1, 2]\n" for number in range(70))
    path = str(write_sweep(tmp_path, "[grid]\n" + pairs))
    with pytest.raises(UsageError, match=f"{2**32} points: .* at most 50000 points"):
        read_sweep(path)


def test_what_may_be_left_out_is_said(tmp_path):
    path = tmp_path / "less.toml"
    path.write_text('scenario = "line"\nwithout = ["identifed"]\n')
    with pytest.raises(UsageError, match="give a list of identified and comp"):
        read_sweep(str(path))


def test_the_first_points_that_are_walked_tell_of_the_time_that_all_take(tmp_path):
    """Walks with higher lifts take longer than others."""
    varies = "[grid]\nlift_height = [0.01, 0.015, 0.02, 0.03]\ndraw = [1, 2, 3, 4]\n"
    points = points_of(read_sweep(str(write_sweep(tmp_path, varies))), Shard())
    heights = [task.table["lift_height"] for task in points.tasks(known=())]
    assert sorted(heights[:4]) == [0.01, 0.015, 0.02, 0.03]
    assert len(heights) == 16


def test_walks_of_one_plan_come_one_after_another(tmp_path):
    varies = '[grid]\nfriction = [0.5, 1.0]\nstance = ["centred", "paper"]\n'
    points = points_of(read_sweep(str(write_sweep(tmp_path, varies))), Shard())
    tasks = [task.table for task in points.tasks(known=())]
    found = [(task["stance"], task["friction"]) for task in tasks]
    assert found == [
        ("centred", 0.5), ("centred", 1.0), ("paper", 0.5), ("paper", 1.0)
    ]  # fmt: skip


@pytest.mark.parametrize("friction", ["1979-05-27", "inf", "nan"])
def test_a_scenario_s_value_that_no_file_of_results_can_hold_is_refused(
    tmp_path, friction
):
    """Though the sweep gives others in its place."""
    path = tmp_path / "s.toml"
    own = f'friction = {friction}\npath = {{ kind = "line", goal = [0.005, 0, 0] }}\n'
    path.write_text(f"{own}[grid]\nfriction = [0.5, 1.0]\n")
    sweep = read_sweep(str(path))
    assert sweep.at(0).friction == 0.5
    with pytest.raises(UsageError, match="give numbers and texts, also where other"):
        About.of(sweep)


def test_names_longer_than_any_setting_s_are_refused_at_once():
    assert dict(flat({"a" * 99: {"b" * 99: 1}}))
    with pytest.raises(UsageError, match="no setting is called 'aaa"):
        dict(flat({"a" * 100: {"b" * 100: 1}}))
