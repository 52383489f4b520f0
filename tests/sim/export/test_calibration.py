"""Servos found one at a time: a simulated board hides where they are and how."""

import re
from importlib.resources import files
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from models import SERVO_KINDS, load
from models.description import board_divider
from sim.cli import main
from sim.export.calibration import marks, strokes
from sim.export.header import read_header
from sim.export.servo_table import servo_table
from tests.commands import full_disk

MAKE = SERVO_KINDS["mg90"]
ROBOT = "hexapod-classroom"
NOMINAL = 102  # divider of 25 MHz for some 60 frames a second


class Board:
    """Servos on hidden channels, each with a sign, a centre and a gain of its own."""

    def __init__(self, draw, clock=25.87e6):
        random = np.random.default_rng(draw)
        self.joints = load(ROBOT).card.joints
        self.clock, number = clock, len(self.joints)
        self.channel = random.permutation(16)[:number]
        self.sign = random.choice((-1, 1), number)
        self.centre = random.uniform(1400, 1600, number)  # [us] at angle 0
        self.gain = random.uniform(0.9, 1.1, number) * 2000 / np.pi  # [us/rad]

    def count(self, joint, angle, divider):
        """The count at which a joint stands at an angle, not rounded."""
        i = self.joints.index(joint)
        pulse = self.centre[i] + self.sign[i] * self.gain[i] * angle
        return pulse * 1e-6 * self.clock / divider

    def angle(self, joint, count, divider):
        """The angle that a joint is turned to by a count."""
        i = self.joints.index(joint)
        pulse = count * 1e6 * divider / self.clock
        return self.sign[i] * (pulse - self.centre[i]) / self.gain[i]

    def owner(self, stop=None):
        """Who answers questions, and leaves after some."""
        robot, joint, asked = load(ROBOT), None, 0

        def answer(question):
            nonlocal joint, asked
            asked += 1
            if stop is not None and asked > stop:
                raise EOFError
            if "clock" in question:
                return f"{self.clock / 1e6:.3f}"
            if "joint moved" in question:
                channel = int(re.search(r"channel (\d+)", question)[1])
                here = np.flatnonzero(self.channel == channel)
                joint = self.joints[here[0]] if len(here) else None
                return joint or "-"
            i = self.joints.index(joint)
            if "(+)" in question:
                return "+" if self.sign[i] > 0 else "-"
            mark = int(re.search(r"mark (\d)", question)[1]) - 1
            return str(round(self.count(joint, marks(robot, joint)[mark], NOMINAL)))

        return answer


@pytest.fixture
def calibrate(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("sim.export.calibration.draw", lambda *_, **__: None)
    monkeypatch.setattr("sys.stdin", SimpleNamespace(isatty=lambda: True))

    def begin(answer, *words):
        monkeypatch.setattr("builtins.input", answer)
        return main(["calibrate", *words])

    return begin


def found(path="calibration/hexapod-classroom.xml"):
    card = load(path).card
    return card, servo_table(card, card.joints, MAKE, pwm=True, rate=60.0)


@pytest.mark.parametrize("clock", [25e6, 25.87e6, 24.1e6])
def test_a_hidden_board_is_found_to_half_a_count(calibrate, clock):
    board = Board(1, clock)
    assert calibrate(board.owner(), ROBOT) == 0
    card, table = found()
    assert card.board_clock == pytest.approx(clock, abs=500)  # told to a kilohertz
    divider, robot = board_divider(60.0, clock), load(ROBOT)
    for servo in table.channels:
        assert servo.channel == board.channel[board.joints.index(servo.joint)]
        angles = np.linspace(*marks(robot, servo.joint), 9)
        true = board.count(servo.joint, angles, divider)
        # each mark is told to half a count of the sketch's divider
        assert np.abs(servo.counts(angles) - true).max() <= 0.5 * NOMINAL / divider


@pytest.mark.parametrize("rate", [0.0, 40.0, 50.0, 60.0, 100.0, 300.0])
@pytest.mark.parametrize("told", ["", "clock = 25.87e6\n"])
def test_servos_are_given_the_pulses_they_were_found_at(calibrate, rate, told):
    """At any rate of frames, and if the clock was measured after the servos."""
    board, path = Board(3, 25.87e6), Path("calibration/hexapod-classroom.toml")
    owner, robot = board.owner(), load(ROBOT)
    assert calibrate(lambda q: "" if "clock" in q else owner(q), ROBOT) == 0
    found_at = f"divider = {NOMINAL}"
    assert found_at in (text := path.read_text())
    path.write_text(text.replace(found_at, told + found_at))
    card = found()[0]
    table = servo_table(card, card.joints, MAKE, pwm=True, rate=rate)
    divider = board_divider(table.frame_rate, card.board_clock)
    for servo in table.channels:
        angles = np.linspace(*marks(robot, servo.joint), 9)
        counts = servo.counts_per_radian * (angles - servo.offset)
        off = servo.center + servo.sign * counts
        off -= board.count(servo.joint, angles, divider)
        assert np.abs(off).max() <= 0.51 * NOMINAL / divider


def test_sketch_and_script_jog_a_servo_by_as_many_counts(calibrate):
    assert calibrate(Board(1).owner(), ROBOT) == 0
    script = files("sim.templates").joinpath("bus.txt").read_text()
    for tool in (Path("calibration/jog.ino").read_text(), script):
        assert re.findall(r"goes up .*by (\d+) counts", tool) == ["20"]
        assert re.findall(r"\bJOG = (\d+)", tool) == ["20"]


def test_work_that_stops_goes_on_with_what_is_kept(calibrate, capsys, monkeypatch):
    board = Board(2)
    with monkeypatch.context() as full:  # a servo that cannot be written is not kept
        full.setattr("sim.commands.calibrate.whole", full_disk)
        assert calibrate(board.owner(), ROBOT) == 6
    assert "keeps 0 of 12 servos" in told_of(capsys)
    assert calibrate(board.owner(stop=7), ROBOT) == 2
    said = "calibration/hexapod-classroom.toml keeps 1 of 12 servos; go on: stratawalk"
    assert said in told_of(capsys)
    asked, answer = [], board.owner()
    card = Path("calibration/hexapod-classroom.toml")

    def owner(question):
        if not asked:  # who edits the card meanwhile
            mine = re.sub(r"clock = \d+", "clock = 25800000", card.read_text())
            card.write_text(f"# I\n{mine}limits = [-0.3, 0.3]\n")
        asked.append(question)
        return answer(question)

    assert calibrate(owner, ROBOT) == 0
    assert not any("clock" in question for question in asked)
    servos, clock = found()[0].joint_servos.values(), found()[0].board_clock
    assert (len(servos), [*servos][0].limits, clock) == (12, (-0.3, 0.3), 25.8e6)
    assert "# I\n" in card.read_text()


def told_of(capsys):
    return capsys.readouterr().err


def test_a_servo_on_a_bus_is_asked_for_by_the_line_that_jogs_it(calibrate, tmp_path):
    robot, asked = load(ROBOT), list[str]()
    card, changed = re.subn('kind = "[^"]*"', 'kind = "sts3215"', robot.card_text)
    (tmp_path / "own.toml").write_text(card)
    (tmp_path / "own.xml").write_text(robot.read().to_xml())

    def leave(question):
        asked.append(question)
        raise EOFError

    assert (changed, calibrate(leave, "own.xml")) == (1, 2)
    # half of the turn that its data sheet divides by 4096
    assert "joint moved by j 1 2048 " in asked[0]


def test_answers_are_read_from_a_file(calibrate, tmp_path, capsys):
    lines, answer = [], Board(6).owner()

    def owner(question):
        lines.append(answer(question))
        return lines[-1]

    assert calibrate(owner, ROBOT) == 0
    card = Path("calibration/hexapod-classroom.toml").read_text()
    Path("told.txt").write_text("\n".join(lines))
    assert calibrate(None, ROBOT, "--out", "again", "--answers", "told.txt") == 0
    assert card == Path("again/hexapod-classroom.toml").read_text()
    *_, advised = re.findall("next +stratawalk (.*)", capsys.readouterr().out)
    assert main(advised.split()) == 0
    assert Path("again/check.h").is_file()  # of the same folder
    assert calibrate(None, ROBOT, "--out", "new", "--answers", "none.txt") == 2
    assert "give answers, a line each" in told_of(capsys)


def test_counts_that_no_such_servo_needs_are_asked_again(calibrate, capsys):
    answer, wrong = Board(3).owner(), iter(["900"])

    def owner(question):
        right = answer(question)
        return next(wrong, right) if "mark 2," in question else right

    assert calibrate(owner, ROBOT) == 0
    assert "look at the marks again" in capsys.readouterr().out


@pytest.mark.parametrize("mistake", ["none", "sign", "zero"])
def test_strokes_show_a_wrong_sign_and_a_zero_a_degree_off(calibrate, capsys, mistake):
    board, robot, joint = Board(4), load(ROBOT), "swing_3"
    assert calibrate(board.owner(), ROBOT) == 0
    if mistake == "sign":
        board.sign[board.joints.index(joint)] *= -1
    if mistake == "zero":
        i = board.joints.index(joint)
        board.centre[i] += np.radians(1.0) * board.gain[i]
    assert calibrate(None, ROBOT, "--check") == 0  # its copy, with what was found
    assert "wrong sign" in capsys.readouterr().out
    _, table = found()
    header = Path("calibration/check.h").read_text()
    counts = table.counts(read_header(header, table))
    wanted = strokes(robot, table.frame_rate)[0]
    divider = board_divider(60.0, board.clock)
    column = [servo.joint for servo in table.channels].index(joint)
    turned = board.angle(joint, counts[:, column], divider)
    meant = wanted.angles[:, wanted.joints.index(joint)]
    apart = np.degrees(turned - meant)
    count = np.degrees(MAKE.resolution)  # half of one as told, and half as rounded
    if mistake == "none":
        assert np.abs(apart).max() < 1.2 * count
    elif mistake == "zero":  # the foot is on the edge of its ring, not in its middle
        assert np.abs(np.abs(apart) - 1).max() < 1.2 * count
    else:  # the leg turns the other way
        most = np.abs(meant).argmax()
        assert turned[most] * meant[most] < 0


def test_a_card_keeps_what_is_not_of_single_servos(calibrate):
    calibrate(Board(5).owner(), ROBOT)
    card = Path("calibration/hexapod-classroom.toml")
    first = card.read_text()
    assert "# Legs farther from their tripod's pivot swing farther" in first
    calibrate(None, "calibration/hexapod-classroom.xml")
    assert card.read_text() == first


@pytest.mark.parametrize(
    ("row", "header"),
    [
        ("channel = 3", "[ servo.lift_1 ]"),
        ("channel = 3", '["servo".lift_1]'),
        ("channel = 3", "[servo . lift_1]"),
        ("clock = 25.5e6", "[ board ]"),
    ],
)
def test_tables_are_replaced_however_their_headers_are_written(calibrate, row, header):
    card = stranger(f"{header}\n{row}\n# of mine\n[fitted]\n")
    assert calibrate(Board(5).owner(stop=5), "own.xml") == 2
    assert header not in (text := card.read_text())
    assert "# of mine\n[fitted]\n" in text
    kept = load("own.xml").card
    if "clock" in row:
        assert kept.board_clock == 25.5e6
    else:
        assert kept.joint_servos["lift_1"].channel == 3


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("[servo]", "[servo]\nlift_1.channel = 3"),
        ("description", "board.clock = 25e6\ndescription"),
    ],
)
def test_a_card_in_which_servos_would_stand_twice_is_refused_as_it_is(
    calibrate, capsys, old, new
):
    card = stranger()
    card.write_text(card.read_text().replace(old, new, 1))
    before = card.read_text()
    assert calibrate(Board(5).owner(), "own.xml") == 2
    assert "begin their tables with lines [servo.JOINT]" in told_of(capsys)
    assert card.read_text() == before


def stranger(below=""):
    """A card of an owner's own in this folder, with a table at its end."""
    shipped, card = load(ROBOT), Path("own.toml")
    Path("own.xml").write_text(shipped.read().to_xml())
    card.write_text(f"{shipped.card_text}\n{below}")
    return card


def test_what_is_not_calibrated_is_not_checked(calibrate, capsys):
    assert calibrate(None, ROBOT, "--check") == 2
    assert "find them first: stratawalk calibrate" in told_of(capsys)
