"""A point is its settings and everything that its robot is made of."""

import os

import pytest

from sim.scenarios.body_path import line
from sim.scenarios.file import to_table
from sim.sweeps.ledger import digest
from sim.sweeps.worker_pool import Task
from tests.sweeps import walked_here, write_sweep


def test_a_point_is_another_one_if_a_file_that_its_model_includes_changes(
    edited, scenario
):
    robot = edited()
    point = scenario(robot=str(robot.path))
    before = digest(point, ())
    assert digest(point, ()) == before
    scene = robot.path.parent / "scene.xml"
    scene.write_text(scene.read_text().replace("<worldbody>", "<worldbody> "))
    assert digest(point, ()) != before


def test_a_file_that_an_included_file_names_since_it_was_changed_is_part_of_a_point(
    edited, scenario
):
    robot = edited()
    scene, more = (robot.path.parent / name for name in ("scene.xml", "more.xml"))
    point, text = scenario(robot=str(robot.path)), scene.read_text()
    found = [digest(point, ())]
    for change in ('<include file="more.xml"/>', "</include>", ""):
        more.write_text(f"<mujoco><option/><!--{change}--></mujoco>")
        scene.write_text(text.replace("</mujoco>", f"{change}</mujoco>"))
        found.append(digest(point, ()))
        more.write_text(f"<mujoco><option/><!--{change} again--></mujoco>")
        found.append(digest(point, ()))
    first, named, changed, broken, kept, back, _ = found
    assert len({first, named, changed, broken}) == 4
    assert broken == kept != back == first


def test_names_make_no_other_point(scenario):
    assert digest(scenario(name="a"), ()) == digest(scenario(name="b"), ())
    assert digest(scenario(), ()) != digest(scenario(), ("identified",))


def test_a_point_is_another_one_if_the_motion_that_it_plays_changes(scenario, tmp_path):
    log = tmp_path / "log.csv"
    log.write_text("time,swing_1\n0,0\n1,0.1\n")
    point = scenario(motion=str(log))
    before = digest(point, ())
    log.write_text("time,swing_1\n0,0\n1,0.11\n")
    assert digest(point, ()) != before


def test_a_lasting_worker_walks_the_robot_as_its_file_is_now(edited, scenario):
    """And says what it has walked, so that nothing stands under another robot."""
    robot = edited()
    point = scenario(robot=str(robot.path), segments=1, path=line((0.005, 0, 0)))
    left_out = ("identified", "compliant", "creep_floor")
    task = Task(digest(point, left_out), to_table(point), left_out)
    before, again = task.carry_out(), task.carry_out()
    assert before == again
    text = robot.path.read_text()
    robot.path.write_text(text.replace('type="box" mass="1"', 'type="box" mass="3"'))
    heavy = task.carry_out()
    assert heavy.digest == digest(point, left_out) != before.digest == task.digest
    assert heavy.status == "ok"
    assert heavy.numbers != before.numbers


def test_no_file_is_read_into_memory_whatever_its_size(scenario, tmp_path):
    log = tmp_path / "log.csv"
    log.touch()
    os.truncate(log, 3 * 10**9)
    with pytest.raises(OSError, match="larger than 1000 MB"):
        digest(scenario(motion=str(log)), ())


@pytest.mark.physics
def test_a_sweep_goes_on_with_a_word_where_its_robot_has_become_another(
    edited, tmp_path
):
    robot = edited().path
    file = write_sweep(tmp_path, f'[grid]\nrobot = ["{robot}"]\n')
    text, goal = file.read_text(), "[0.002, 0.002, 0]"
    assert goal in text
    file.write_text(text.replace(goal, "[0.002, 0.002, 7]"))  # [rad]
    words, first = ("sweep", file, "--out", tmp_path / "out"), "1 point, 0 of them done"
    done = walked_here(*words)
    assert done.stdout.startswith(f"{first} before\n")
    assert "yaw is in radians: 7 degrees is 0.12217" in done.stderr
    robot.write_text(f"{robot.read_text()}<!-- heavier -->\n")
    robot.with_suffix(".toml").unlink()  # its model is named as the shipped one is
    done = walked_here(*words, "--resume")
    said = done.stdout.splitlines()[0]
    assert f"{robot} has no card beside it; " in done.stderr
    why = "its ledger has no finished walk of these robots and settings"
    assert said == f"{first} before; {why}"
