"""Servo tables in the YAML that ROS packages have."""

from math import radians

import numpy as np
import pytest

from sim.errors import UsageError
from sim.export.ros_table import read_ros_table
from sim.export.servo_table import servo_table
from tests.sim.export.test_source import CARD, JOINTS, MG90

SERVO = (
    "name: {}, id: {}, ticks: 1024, center: 512, max_radians: !degrees 300, "
    "sign: {}, offset: !degrees 14"
)


def written(tmp_path, text):
    path = tmp_path / "servos.yaml"
    path.write_text(text)
    return path


def listed(form="- {{{}}}\n", sign=-1):
    servos = (SERVO.format(joint, 20 - n, sign) for n, joint in enumerate(JOINTS))
    return "".join(form.format(servo) for servo in servos)


@pytest.mark.parametrize("sign", [1, -1])
def test_ticks_are_those_that_the_ros_driver_would_send(tmp_path, sign):
    given = read_ros_table(written(tmp_path, listed(sign=sign)))
    servos = servo_table(CARD, JOINTS, MG90, False, given)
    assert [s.channel for s in servos.channels] == list(range(9, 21))
    assert servos.joints == JOINTS[::-1]
    angle = 0.3
    wanted = 512 + sign * (angle - radians(14)) * 1024 / radians(300)
    assert servos.channels[0].counts(np.array(angle)) == pytest.approx(wanted)
    assert servos.channels[0].angle(np.array(wanted)) == pytest.approx(angle)


@pytest.mark.parametrize("sign", [1, -1])
def test_limits_are_the_first_and_the_last_tick(tmp_path, sign):
    given = read_ros_table(written(tmp_path, listed(sign=sign)))
    (servo, *_) = servo_table(CARD, JOINTS, MG90, False, given).channels
    ends = sorted(servo.counts(np.array([servo.low, servo.high])).tolist())
    assert ends == pytest.approx([0, 1023])


def test_servos_may_stand_under_a_name_and_have_keys_of_their_own(tmp_path):
    plain = read_ros_table(written(tmp_path, listed()))
    servos = (f"  {n}: {{{SERVO.format(j, 20 - n, -1)}}}" for n, j in enumerate(JOINTS))
    text = "RATE: 500\nSERVOS:\n" + "\n".join(servos)
    assert read_ros_table(written(tmp_path, text)) == plain


@pytest.mark.parametrize("number", ["1e-3", "0.1E-2", ".00001e2", "0.00001e2", "1.e-3"])
def test_numbers_are_those_of_yaml_1_2_as_ros_reads_them(tmp_path, number):
    plain = listed().replace("!degrees 14", "0.001")
    given = read_ros_table(written(tmp_path, plain.replace("0.001", number)))
    assert given == read_ros_table(written(tmp_path, plain))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[", "not YAML"),
        ("", "no servos"),
        ("[]", "no servos"),
        ("- 3", "servo 1 must be a table, got 3"),
        (
            listed().replace("offset", "ofset", 1),
            "no key 'ofset'; did you mean 'offset",
        ),
        (listed().replace("offset", "7", 1), "no key 7; there are name, id"),
        (listed().replace("offset", "null", 1), "no key None; there are name"),
        ("- {name: a, id: 1}", "servo 1.ticks is missing"),
        ("[" * 5000, "not YAML"),
        (f"- {{name: a, center: 1{':59' * 200}.5}}", "not YAML"),
        ('- {name: "\\Uffffffff"}', "not YAML"),
        ("x: !!map [a, b]", "not YAML"),
        (listed().replace("sign: -1", "sign: -1, sign: 1", 1), "'sign' stands there"),
        (listed().replace("1024", "1" + "0" * 400), "ticks must be a number"),
        (listed().replace("512", ".inf"), ".inf is no decimal number"),
        ("- &a 1\n- *a\n", "write aliases out in .*line 2"),
        (listed().replace("512", "x"), "center must be a number, got 'x'"),
        (listed().replace("id: 20", "id: x"), "id must be a whole number"),
        (listed().replace("id: 20", "id: 020"), "020 is no decimal number, such as 10"),
        (listed().replace("id: 20", "id: 1:10"), "1:10 is no decimal number"),
        (listed().replace("id: 20", "id: 0x10"), "0x10 is no decimal number"),
        (listed().replace("1024", "0"), "must be positive"),
        (listed().replace("sign: -1", "sign: 3"), "sign must be 1 or -1"),
        (listed().replace("swing_2", "swing_1"), "'swing_1' is there twice"),
        ("!!python/object/apply:os.getcwd []", "not YAML"),
        ('!!int ""', "is no decimal number"),
        ('!!float ""', "is no decimal number"),
        ('!!timestamp "x"', "not of its tag"),
        ('!!bool "x"', "not of its tag"),
    ],
)
def test_what_is_no_servo_table_is_refused(tmp_path, text, said):
    with pytest.raises(UsageError, match=said):
        read_ros_table(written(tmp_path, text))


def test_aliases_that_would_not_end_are_refused_at_once(tmp_path):
    lines = [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9)}]" for i in range(1, 30)]
    bomb = written(tmp_path, "a0: &a0 [1]\n" + "\n".join(lines))
    with pytest.raises(UsageError, match="write aliases out") as refused:
        read_ros_table(bomb)
    assert len(str(refused.value)) < 500


def test_a_table_is_read_in_a_second_or_not_at_all(tmp_path):
    with pytest.raises(UsageError, match="larger than 0.1 MB"):
        read_ros_table(written(tmp_path, listed() + "#" * 10**5))


def test_a_file_that_is_not_there_is_refused(tmp_path):
    with pytest.raises(UsageError, match="cannot be read"):
        read_ros_table(tmp_path / "none.yaml")
