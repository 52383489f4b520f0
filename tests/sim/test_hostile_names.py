"""A thousand names of joints, robots and scenarios that nobody would choose.

Those that cannot be written everywhere are refused; the others come through every
writer as they are, and do nothing on their way.
"""

import io
import re
import shutil
import subprocess
import tomllib

import mujoco
import numpy as np
import pandas as pd
import pytest
import yaml

from models import JointServo, ModelError, load
from models.description import (
    compile_model,
    is_plain,
    parse_toml,
    servo_of,
    toml_key,
    toml_text,
)
from sim.cli import main
from sim.errors import UsageError, one_line
from sim.evaluation import flows
from sim.export import source
from sim.export.servo_commands import ServoCommands
from sim.export.servo_table import servo_table
from tests.finished_runs import phase
from tests.hostile import named_otherwise, names

NAMES = names(1000)
PLAIN = [name for name in NAMES if is_plain(name)]
ODD = [name for name in NAMES if not is_plain(name)]


def batched(found, size):
    """Some at a time; none of them empty, as no joint's name is."""
    found = [name for name in found if name]
    return [tuple(found[i : i + size]) for i in range(0, len(found), size)]


def test_most_kinds_of_names_are_drawn():
    assert not any(map(is_plain, (" a", "a ", "a\\", "a\n")))  # readers strip blanks
    assert len(PLAIN) > 300
    assert len(ODD) > 300


def test_names_come_through_xml_as_they_are():
    spec = mujoco.MjSpec()
    for name in PLAIN:
        body = spec.worldbody.add_body()
        body.add_joint(name=name)
        body.add_geom(size=[1, 1, 1], type=mujoco.mjtGeom.mjGEOM_SPHERE)
    compile_model(spec, "here")
    again = mujoco.MjSpec.from_string(spec.to_xml())
    assert [joint.name for joint in again.joints] == PLAIN


def test_odd_names_are_refused_in_one_printable_line():
    refused = 0
    for name in ODD:
        spec = mujoco.MjSpec()
        body = spec.worldbody.add_body()
        if "\ud800" in name:  # half a character, which no file can hold
            continue
        joint = body.add_joint(name=name)
        body.add_geom(size=[1, 1, 1], type=mujoco.mjtGeom.mjGEOM_SPHERE)
        if joint.name != name:  # the engine has cut it off
            continue
        with pytest.raises(ModelError, match="use printable characters") as found:
            compile_model(spec, "here")
        assert one_line(found.value).isprintable()
        refused += 1
    assert refused > 300


def test_names_come_through_toml_as_they_are():
    text = "\n".join(f"{toml_key(name)} = {toml_text(name)}" for name in PLAIN if name)
    assert parse_toml(text) == {name: name for name in PLAIN if name}
    text = "\x7f\x01\n"
    assert tomllib.loads(f"a = {toml_text(text)}") == {"a": text}


def commands_of(joints):
    values = np.linspace(0, 0.1, 3)[:, None] * np.ones(len(joints))
    return ServoCommands(tuple(joints), 50.0, values)


def exported(form, joints):
    """What a writer makes of joints of such names, and what its reader does."""
    commands = commands_of(joints)
    given = {name: JointServo(channel=i) for i, name in enumerate(joints)}
    card = load("hexapod").card
    table = servo_table(card, joints, servo_of("mg90"), source.PWM[form], given)
    return commands, table


@pytest.mark.parametrize("form", ["csv", "dynamixel"])
def test_pandas_reads_every_name_as_it_is(form):
    for joints in batched(PLAIN, 12):
        commands, table = exported(form, joints)
        if form == "csv":
            text = source.write_table(commands)
            assert source.read_table(text).joints == tuple(joints)
        else:
            text = source.write_table(commands, table)
            assert source.read_table(text, table).joints == tuple(joints)
        assert list(pd.read_csv(io.StringIO(text)).columns) == ["time", *joints]


@pytest.mark.parametrize("loader", [yaml.SafeLoader, source.LOADER])
def test_yaml_gives_every_name_as_it_is(loader):
    for joints in batched(PLAIN, 50):
        text = source.write_trajectory(commands_of(joints))
        assert source.read_trajectory(text).joints == joints
        assert yaml.load(text, Loader=loader)["joint_names"] == list(joints)


def test_a_c_compiler_takes_every_header(tmp_path):
    """Scenario, robot and file as well, whatever a run's files say that they are."""
    compiler = shutil.which("gcc") or pytest.skip("NO GCC here: headers not compiled")
    header = tmp_path / "walk.h"
    for joints in batched(NAMES, 40):  # the refused ones, too
        commands, table = exported("header", joints)
        title = f"{joints[0]} on {joints[1 % len(joints)]}"
        text = source.write_header(
            commands, table, title=title, name=joints[0], file=joints[-1]
        )
        assert source.read_header(text, table).angles.shape == commands.angles.shape
        header.write_text(text)
        for language in ("-std=c99", "-std=gnu17"):
            done = subprocess.run(
                [compiler, "-Wall", "-Wextra", "-Wno-unused-variable", "-Werror",
                 language, "-fsyntax-only", "-x", "c", header],
                capture_output=True, text=True,
            )  # fmt: skip
            assert done.returncode == 0, done.stderr
        done = subprocess.run([compiler, "-E", "-P", header], capture_output=True)
        assert "INJECTED" not in done.stdout.decode()


def test_lines_of_phases_come_through_as_they_are():
    drawn = [
        phase("swing", name, name)._replace(start=float(i), end=i + 1.0)
        for i, name in enumerate(PLAIN)
    ]
    assert flows.read(flows.written(drawn)) == tuple(drawn)


def test_scenarios_have_plain_names(scenario):
    for name in NAMES:
        if is_plain(name) and name and name[0] not in ".-" and "/" not in name:
            assert scenario(name=name).name == name
        else:
            with pytest.raises(
                UsageError, match="text in quotation marks, without slashes"
            ) as found:
                scenario(name=name)
            assert one_line(found.value).isprintable()


@pytest.mark.parametrize(
    "joint",
    ["x&#10;#error INJECTED&#10;//", "x&#13;y", "swing\\", "a\u202eb", "\x1b[2J"],
)
@pytest.mark.parametrize("command", ["robots", "adopt"])
def test_a_robot_with_such_a_joint_is_refused(joint, command, tmp_path, capsys):
    path = named_otherwise(tmp_path, joint)
    if command == "adopt":
        path.with_suffix(".toml").unlink()
    before = sorted(tmp_path.iterdir())
    assert main([command, str(path)]) == 3
    (line,) = capsys.readouterr().err.splitlines()
    assert re.search("is no name for a part|not a usable MJCF", line)
    assert line.isprintable()
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize("file", ["a\nb", "a\\", "a\x1b[2J"])
def test_a_robot_in_a_file_of_such_a_name_is_refused(file, tmp_path, capsys):
    assert main(["robots", str(named_otherwise(tmp_path, "x", file))]) == 3
    (line,) = capsys.readouterr().err.splitlines()
    assert "is no name for a part or a robot" in line
    assert line.isprintable()
