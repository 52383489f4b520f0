"""Calibrations and packed headers at the borders of what they take."""

from math import pi, radians
from types import SimpleNamespace

import numpy as np
import pytest

from models import SERVO_KINDS, Kinematics, load
from models.description import board_divider
from models.description.servos import JointServo
from sim.export import calibration
from sim.export.calibration import (
    MARK,
    card_with,
    joint_servo,
    marks,
    sheet,
    strokes,
)
from sim.export.header import identifier, in_comment, pack, unpack

SWING, SECONDS = radians(15), 2.0  # of the strokes that check

MG90, BUS = SERVO_KINDS["mg90"], SERVO_KINDS["ax-12"]


@pytest.mark.parametrize(
    ("share", "fine"), [(0.49, False), (0.51, True), (1.98, True), (2.03, False)]
)
def test_half_to_twice_the_counts_of_the_make_are_believed(share, fine):
    apart = 1.0
    needed = round(share * apart / MG90.resolution)
    counts = (300, 300 + needed)
    if fine:
        found = joint_servo(MG90, 102, 2, "+", counts, (-0.5, 0.5))
        assert found.counts_per_radian == pytest.approx(needed)
    else:
        said = f"{needed} counts for 57 degrees, and its make takes 111"
        with pytest.raises(ValueError, match=said):
            joint_servo(MG90, 102, 2, "+", counts, (-0.5, 0.5))


@pytest.mark.parametrize("clock", [25e6, 26.5e6])
@pytest.mark.parametrize("turned", ["+", "-"])
def test_centre_offset_and_sign_follow_from_two_marks(clock, turned):
    """The divider of a board is rounded for its clock, and that of the ideal one."""
    counts = (280, 400) if turned == "+" else (400, 280)
    divider = board_divider(60.0, clock)
    found = joint_servo(MG90, divider, 5, turned, counts, (-0.4, 0.8))
    longer = divider / board_divider(60.0)
    assert (found.channel, found.sign) == (5, 1 if turned == "+" else -1)
    assert found.center == pytest.approx(340 / longer)
    assert found.offset == pytest.approx(0.2)
    assert found.counts_per_radian == pytest.approx(100 / longer)
    bus = joint_servo(
        BUS, 0, 5, turned, counts if turned == "+" else (400, 280), (-0.4, 0.4)
    )
    assert bus.counts_per_radian == pytest.approx(150.0)
    still = (300, 300)
    with pytest.raises(ValueError, match="look at the marks again"):
        joint_servo(MG90, divider, 5, turned, still, (-0.4, 0.8))


def test_marks_are_thirty_degrees_away_or_at_the_end_of_the_range():
    robot = load("hexapod-classroom")
    for joint in robot.card.joints:
        stands, (low, high) = robot.standing_angle(joint), robot.span(joint)
        first, second = marks(robot, joint)
        assert low <= first < stands < second <= high
        assert first == max(stands - radians(30), low)
        assert second == min(stands + radians(30), high)
    assert radians(30) == MARK
    limits = {"held": (0.0, 0.3), "aside": (-0.1, 0.0), "far": (0.9, 2.0)}
    servos = {joint: JointServo(limits=ends) for joint, ends in limits.items()}
    own = SimpleNamespace(joint_servos=servos)
    narrow = SimpleNamespace(
        card=own, standing_angle=lambda j: 0.1, span=lambda j: (-0.1, 0.2)
    )
    assert marks(narrow, "j") == (-0.1, 0.2)
    assert marks(narrow, "aside") == (-0.1, 0.0)
    narrow.span = lambda j: (-2.0, 2.0) if j == "far" else (-0.1, 0.2)
    assert marks(narrow, "far") == (0.9, 0.9 + MARK)  # where it does not stand
    assert marks(narrow, "held") == (0.0, 0.2)  # of the servo, which may hit a stop


def test_strokes_turn_all_legs_then_raise_all_feet_and_then_each():
    robot, rate = load("hexapod-classroom"), 20.0
    found, meanings = strokes(robot, rate)
    legs, rise = len(robot.legs), round(SECONDS * rate)
    length = 4 * rise
    assert len(found.angles) == (2 + legs) * length
    rest = np.array([robot.standing_angle(joint) for joint in found.joints])
    moved = found.angles - rest
    swings = [found.joints.index(leg.swing) for leg in robot.leg_cards]
    lifts = [found.joints.index(leg.lift) for leg in robot.leg_cards]
    middle = length // 4 + rise // 2
    kinematics = Kinematics(robot)
    for leg, swing in zip(robot.leg_cards, swings, strict=True):
        axis = kinematics.hinge(leg.swing)[0]
        room = min(
            abs(e - robot.standing_angle(leg.swing)) for e in robot.span(leg.swing)
        )
        # anticlockwise, seen from above
        assert moved[middle, swing] * np.sign(axis[2]) == pytest.approx(
            min(SWING, room)
        )
    assert (moved[middle, lifts] == 0).all()
    for k, (leg, lift) in enumerate(zip(robot.leg_cards, lifts, strict=True)):
        high = leg.raise_sign * robot.card.lift_angle
        assert moved[length + middle, lift] == pytest.approx(high)
        row = moved[(2 + k) * length + middle]
        assert row[lift] == pytest.approx(high)
        assert np.count_nonzero(row) == 1
    for stroke in range(2 + legs):  # it begins and ends at rest, with a while between
        part = moved[stroke * length : (stroke + 1) * length]
        assert (part[0] == 0).all()
        assert (part[3 * rise :] == 0).all()
        most = np.abs(part).max(axis=0)
        assert np.abs(part[rise : 2 * rise]) == pytest.approx(np.tile(most, (rise, 1)))
    assert [*meanings] == ["0 to 8 s", "to 16 s", "to 64 s"]


def test_a_sheet_has_feet_in_rings_of_a_degree_of_their_swing():
    robot = load("hexapod-classroom")
    text = sheet(robot)
    kinematics = Kinematics(robot)
    for card, foot in zip(
        robot.card.legs.values(), kinematics.standing.feet, strict=True
    ):
        hip = kinematics.hinge(card.swing)[1][:2]
        ring = np.linalg.norm(foot - hip) * pi / 180
        assert (
            f" a {1e3 * ring:.3f} {1e3 * ring:.3f} 0 1 0 {2e3 * ring:.3f} 0 a " in text
        )
        bearing = np.degrees(np.arctan2(*(foot - hip)[::-1]))
        assert f", {bearing:.0f}°</text>" in text
    feet = kinematics.standing.feet
    width, height = 1e3 * (np.ptp(feet, axis=0) + 4 * 0.02)  # x is up
    assert f'width="{height:.3f}mm"' in text or f'width="{width:.3f}mm"' in text


def test_servos_replace_those_of_a_card_and_leave_other_tables():
    text = "name = 1\n[servo.one]\nchannel = 8\n[legs]\nx = 1\n[board]\nclock = 1\n"
    servo = JointServo(
        channel=3, sign=-1, center=301.5, offset=0.25, limits=(-1.0, 1.5)
    )
    card = card_with(text, {"one": servo}, 25_870_000.4, 105)
    lines = card.splitlines()
    assert lines[:3] == ["name = 1", "[legs]", "x = 1"]
    assert "clock = 25870000  # [Hz], measured" in lines
    assert "divider = 105  # of the clock, for the counts below" in lines
    below = lines[lines.index("[servo.one]") + 1 :]
    numbers = ["channel = 3", "sign = -1", "center = 301.5", "offset = 0.25"]
    assert below == [*numbers, "limits = [-1.0, 1.5]"]
    assert card_with("a = 1\n", {}, None, 0) == "a = 1\n"
    assert "[board]\ndivider = 102" in card_with("a = 1\n", {}, None, 102)


@pytest.mark.parametrize("step", [31, -31, 32, -32, 300, 1])
def test_small_changes_take_a_digit_and_others_four(step):
    """A row has a digit for how long it holds, and one for what changes."""
    counts = np.array([[1000, 50], [1000 + step, 50]])
    first, both = pack(counts[:1]), pack(counts)
    assert len(both) - len(first) == 2 + (1 if abs(step) < 32 else 4)
    assert unpack(both, 2).tolist() == counts.tolist()


@pytest.mark.parametrize("held", [1, 62, 63, 64, 126, 127, 200])
def test_a_row_holds_up_to_63_commands(held):
    counts = np.tile([[5, 6, 7]], (held, 1))
    packed = pack(counts)
    assert unpack(packed, 3).tolist() == counts.tolist()
    rows = -(-held // 63)
    assert len(packed) == 2 * rows + 3
    assert [ord(c) - ord("#") for c in packed[:1]] == [min(held, 63)]


@pytest.mark.parametrize("joints", [1, 6, 7, 12, 13])
def test_six_channels_share_a_digit_that_says_which_change(joints):
    counts = np.zeros((2, joints), dtype=int)
    counts[1, -1] = 1
    assert unpack(pack(counts), joints).tolist() == counts.tolist()
    assert len(pack(counts)) == 2 * (1 + -(-joints // 6)) + 1


def test_pulses_of_16_bits_are_packed():
    counts = np.array([[65535, 0], [0, 65535], [4095, 4096]])
    assert unpack(pack(counts), 2).tolist() == counts.tolist()


def test_names_in_c_are_words_and_comments_stay_comments():
    assert identifier("My walk (2)!") == "walk_my_walk_2"
    assert in_comment("a*/b\n?c\\") == "a_/b__c_"


def test_strokes_that_check_go_15_degrees_or_to_the_nearest_end(monkeypatch):
    """Joints stand aside of their middle: 0.1 and 0.5 rad from the nearest end."""
    stands = {"a": 0.3, "b": -0.5, "up": 0.7}
    spans = {"a": (0.2, 0.9), "b": (-1.0, 1.0)}
    axes = {"a": (0.0, 0.0, 1.0), "b": (0.0, 0.6, -0.8)}
    leg = [SimpleNamespace(swing=name, lift="up", raise_sign=1.0) for name in "ab"]
    robot = SimpleNamespace(
        card=SimpleNamespace(joints=[*stands], lift_angle=0.2),
        standing_angle=stands.get, span=spans.get, legs=(1, 2), leg_cards=leg,
    )  # fmt: skip
    fake = SimpleNamespace(hinge=lambda name: (np.array(axes[name]), None))
    monkeypatch.setattr(calibration, "Kinematics", lambda _: fake)
    commands, _ = strokes(robot, 50.0)
    off = commands.angles - [*stands.values()]
    assert np.abs(off).max(axis=0) == pytest.approx([0.1, radians(15), 0.4])
    assert off.max(axis=0)[0] == pytest.approx(0.1)  # anticlockwise from above
    assert off.min(axis=0)[1] == pytest.approx(-radians(15))


@pytest.mark.parametrize(
    ("turned", "counts", "said"),
    [
        ("+", (400, 300), r"turned \+ .* from 400 to 300; look at the marks"),
        ("x", (300, 400), "answer \\+ or -, not 'x'"),
        ("+", (300, 310), "10 counts for 57 degrees, and its make takes 111; look"),
        ("+", (0, 400), "400 counts for 57 degrees, and its make takes 111; look"),
        ("+", (4000, 4096), "there are 4096 counts, and none is 4096"),
    ],
)
def test_answers_that_cannot_be_are_refused(turned, counts, said):
    with pytest.raises(ValueError, match=said):
        joint_servo(MG90, 102, 0, turned, counts, (-0.5, 0.5))
