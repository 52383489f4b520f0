"""What nobody would write ends the command as everything else does."""

import subprocess
import sys
from pathlib import Path

import pytest

from scripts.fuzz import fault
from scripts.fuzz_inputs import KINDS

ROOT = Path(__file__).resolve().parents[2]
SECONDS = {"options": 20, "system": 30, "archive": 20, "scenario": 40, "card": 30}
SECONDS["mjcf"] = 180 - sum(SECONDS.values())  # three minutes in all


@pytest.mark.parametrize("kind", KINDS)
def test_no_mutated_input_breaks_the_command(kind, tmp_path):
    seconds = ("--seconds", str(SECONDS[kind]), "--kinds", kind)
    done = subprocess.run(
        [sys.executable, "-m", "scripts.fuzz", *seconds, "--keep", str(tmp_path)],
        cwd=ROOT,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert " 0 faults" in done.stdout


def test_the_fuzz_sees_what_is_wrong(tmp_path, monkeypatch):
    """A bug, a second line and a silent failure are all faults."""
    from sim import cli

    for code, lines in ((70, "one\n"), (2, "one\ntwo\n"), (2, ""), (0, "one\n")):

        def command(words, code=code, lines=lines):
            sys.stderr.write(lines)
            return code

        monkeypatch.setattr(cli, "main", command)
        assert fault(["run"]) is not None
    monkeypatch.setattr(cli, "main", lambda words: 0)
    assert fault(["run"]) is None


FINDS = {
    "a start beyond all numbers": ("hexapod.xml", "0 0 0.06 1", f"0 0 {2**63} 1"),
}


@pytest.mark.parametrize(("name", "old", "new"), FINDS.values(), ids=FINDS)
def test_what_the_fuzz_found_stays_found(name, old, new, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for file in ("hexapod.xml", "hexapod.toml", "scene.xml"):
        text = (ROOT / "models" / "robots" / file).read_text()
        text = text.replace(old, new) if file == name else text
        (tmp_path / file.replace("hexapod", "mine")).write_text(text)
    assert fault(["robots", "mine.xml"]) is None
