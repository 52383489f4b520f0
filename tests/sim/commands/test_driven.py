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
