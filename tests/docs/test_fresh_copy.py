"""The commands with which README and CONTRIBUTING begin, in a fresh copy."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SHORT = ["--segments", "1", "--set", "path.goal=[0.005,0,0]"]


@pytest.fixture(scope="module")
def copy(tmp_path_factory):
    """The files under version control, in a folder whose name has a space."""
    folder = tmp_path_factory.mktemp("fresh") / "a copy"
    listed = subprocess.run(
        ["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True
    )
    for name in filter(None, listed.stdout.split("\0")):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, folder / name)
    return folder


def run(copy, *words):
    outside = {k: v for k, v in os.environ.items() if not k.startswith("PYTHON")}
    return subprocess.run(words, cwd=copy, env=outside, capture_output=True, text=True)


@pytest.mark.full
@pytest.mark.physics
def test_a_fresh_copy_sets_itself_up_walks_and_tests_itself(copy):
    done = run(copy, "scripts/setup")
    if "a network is needed once" in done.stderr:
        pytest.skip("NO NETWORK: nothing was installed")
    assert done.returncode == 0, done.stderr
    assert "about" in done.stderr  # a line every ten seconds
    assert run(copy, "scripts/setup").stderr == ""  # there is nothing left to do
    walked = run(copy, "scripts/run", *SHORT)
    assert walked.returncode == 0, walked.stderr
    assert walked.stdout.startswith("Arrived")
    assert (copy / "runs" / "line-001" / "report.html").is_file()
    tested = run(copy, "scripts/test", "tests/planner/lie", "-k", "hall")
    assert tested.returncode == 0, tested.stdout + tested.stderr
    assert " passed" in tested.stdout
