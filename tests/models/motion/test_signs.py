"""A card's signs, and the directions of its joints, are a matter of writing only."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from models.description.card import GroupCard
from models.library import load, shipped_robots
from models.motion.robot_equations import equations
from planner.planning.algorithm import plan
from planner.planning.paths import line
from planner.planning.rollouts import rollout

GOAL = (0.15, 0.15, 0.0)
# the quadruped steps anew before every stroke, which takes long; the classroom's robot
# is small, and goes as far in more and shorter segments
SEGMENTS = {"quadruped": 2, "hexapod-classroom": 40}


def negated(robot, groups):
    """The same robot, the angles of some groups counted the other way."""
    card = robot.card
    signs = {name: -1 if name in groups else 1 for name in card.groups}
    turned = {
        name: GroupCard(
            {leg: signs[name] * gain for leg, gain in group.legs.items()},
            group.twist and tuple(signs[name] * rate for rate in group.twist),
        )
        for name, group in card.groups.items()
    }
    patterns = {
        name: replace(
            pattern,
            groups={g: signs[g] * gain for g, gain in pattern.groups.items()},
        )
        for name, pattern in card.patterns.items()
    }
    return replace(robot, card=replace(card, groups=turned, patterns=patterns))


def outcome(robot):
    described = equations(robot)
    path = described.configurations(line((0.0, 0.0, 0.0), GOAL))
    planned = plan(described, path, SEGMENTS.get(robot.name, 10))
    return np.linalg.norm(rollout(planned)[-1][:3] - GOAL), planned.contact_switches


@pytest.mark.parametrize("name", shipped_robots())
def test_whole_groups_negated_on_the_card_walk_as_well(name):
    robot = load(name)
    error, switches = outcome(robot)
    for groups in ("1", "2", "12"):
        turned, events = outcome(negated(robot, groups))
        # 5e-8 of it found: the corner changes brackets beyond the third degree
        assert turned == pytest.approx(error, rel=1e-5)
        assert events == switches


def turned_about(robot, joints, folder):
    """The robot's file with the axes of some joints the other way round."""
    qpos = np.array(robot.start_qpos)
    for joint in joints:
        qpos[robot.model.joint(joint).qposadr[0]] *= -1
    spec = mujoco.MjSpec.from_file(str(robot.path))
    for joint in spec.joints:
        if joint.name in joints:
            joint.axis, joint.range = -joint.axis, -joint.range[::-1]
    for servo in spec.actuators:
        if servo.target in joints:
            servo.ctrlrange = -servo.ctrlrange[::-1]
    for key in spec.keys:
        key.qpos = qpos
    spec.compile()
    path = folder / f"{robot.name}.xml"
    path.write_text(spec.to_xml())
    return path


@pytest.mark.parametrize("name", shipped_robots())
def test_joints_turned_together_with_their_signs_are_the_same_robot(name, tmp_path):
    robot = load(name)
    group = next(iter(robot.card.groups.values()))
    joints = [robot.card.legs[leg].swing for leg in group.legs]
    path = turned_about(robot, joints, tmp_path)
    card = robot.card_text
    was = next(row for row in card.splitlines() if "legs = {" in row)
    signs = ", ".join(f"{leg} = {-gain:.9g}" for leg, gain in group.legs.items())
    before, _, after = was.partition("legs = {")
    now = f"{before}legs = {{ {signs} }}{after[after.index('}') + 1 :]}"
    path.with_suffix(".toml").write_text(card.replace(was, now, 1))
    same = load(str(path))
    plain, turned = equations(robot), equations(same)
    for field, twist in plain.twists.items():
        # 4e-8 found: the engine writes eight digits
        assert turned.twists[field] == pytest.approx(twist, abs=1e-6)
    assert outcome(same) == pytest.approx(outcome(robot), rel=1e-4)
