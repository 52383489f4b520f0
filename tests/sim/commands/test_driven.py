"""What `drive` prints: commands, or with --json what it thinks in the end alone."""

import json
import os

import pytest

from sim.cli import main

WORDS = ["drive", "line", "--pace", "0", "--poses", os.devnull, "--patience", "0.1"]
SETTINGS = ("segments=1", "path.goal=[0.004, 0.0, 0.0]", "sense=tag", "sense_until=0")


@pytest.mark.physics
@pytest.mark.parametrize("as_json", [False, True])
@pytest.mark.parametrize("commands", ["-", os.devnull])
def test_the_end_is_printed_as_json_where_no_commands_are(capsys, as_json, commands):
    words = [*WORDS, *(word for one in SETTINGS for word in ("--set", one))]
    words += ["--commands", commands, *["--json"] * as_json]
    assert main(words) == 0
    lines = capsys.readouterr().out.splitlines()
    if commands == "-":
        assert len(lines) > 10
        assert all("thought" not in json.loads(line) for line in lines)
    elif as_json:
        (end,) = map(json.loads, lines)
        assert end["thought"] == pytest.approx([0.004, 0.0, 0.0], abs=1e-3)
        assert len(end["claimed"]) == 3
    else:
        assert lines == []


@pytest.mark.physics
def test_what_is_scaled_down_to_the_joints_is_told(capsys):
    """The robot is then far from its goal, and nobody may look at it."""
    far = ("--set", "path.goal=[0.15, 0.15, 0.0]", "--set", "segments=1")
    assert main([*WORDS, *far]) == 0
    *_, line = capsys.readouterr().err.splitlines()
    assert line == (
        "stratawalk: warning: 1 of 1 segments were scaled down to the joint range: "
        "walk in more segments (--segments 2)"
    )


@pytest.mark.parametrize(
    ("key", "value"), [("optimise", "time"), ("steer", "compliant"), ("correct", "2")]
)
def test_what_is_for_a_whole_path_is_refused(key, value, capsys):
    assert main([*WORDS, "--set", f"{key}={value}"]) == 2
    line = capsys.readouterr().err.strip()
    assert line.startswith(f"stratawalk: error: {key} = ")
    assert line.endswith(
        f"is for a whole path, and drive plans piece by piece: scenario 'line'; leave "
        f"{key} out"
    )


@pytest.mark.physics
@pytest.mark.parametrize("keys", [("yaw",), ("x", "y", "yaw")])
def test_a_yaw_is_the_gyroscope_s_where_nothing_else_tells_it(tmp_path, capsys, keys):
    """Positions are not told then, be they sent or not."""
    pose = dict.fromkeys(keys, 0.3)
    lines = [json.dumps({"time": 0.02 * k, **pose}) for k in range(500)]
    (tmp_path / "poses.jsonl").write_text("\n".join(lines))
    words = ["drive", "line", "--pace", "0", "--json", "--commands", os.devnull]
    settings = ("segments=1", "path.goal=[0.004, 0.0, 0.0]", "sense=gyro")
    words += [word for one in settings for word in ("--set", one)]
    assert main([*words, "--poses", str(tmp_path / "poses.jsonl")]) == 0
    x, y, yaw = json.loads(capsys.readouterr().out)["thought"]
    # as near as the gyroscope's error by then, 2e-4 rad/s for 6 s, to the robot's own
    assert yaw == pytest.approx(0.3, abs=0.02)
    assert (x, y) == pytest.approx((0.004, 0.0), abs=0.001)
