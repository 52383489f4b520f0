"""Whenever a command is ended, and by whatever signal, the files left are whole.

The same command goes on, or begins anew, and writes what it would have written.
"""

import json
import shlex
import shutil
import signal
import subprocess
import time
import tomllib

import mujoco
import numpy as np
import pytest
from PIL import Image

from models.description.robot import FOLDER
from sim.endings import ENDS
from sim.sweeps.table import write_table
from tests.commands import COMMAND, OUTSIDE, told

CODES = {number: code for number, (code, _) in ENDS.items()}
CODES[signal.SIGKILL] = -signal.SIGKILL
MOMENTS = 20  # spread over a command from its start to its end
AWAKE = 1.0  # [s] until which Python itself may still be starting
WALK = "line --segments 4 --set path.goal=[0.02,0.02,0]"
RATED = "--set command_rate=400"  # without which a notice is given
COMMANDS = {
    "run": f"run {WALK} --no-video --out new",
    "film": "film run --to 0.1 --out new/film.mp4",
    "show": "show run --no-browser",
    "view": "view run --replay --no-browser",
    "compare": "compare run run --out new/page.html",
    "export": f"export {WALK} {RATED} --format csv --out new.csv --no-play",
    "plan": "plan unicycle --save new.json",
    "adopt": "adopt bare.xml",
    "study": "study run --out new",
    "design": "design hexapod --designs 3 --walks 1 --out new.parquet",
    "figures": "figures --only mechanism --out new",
    "merge": "merge swept --out new",
}
DRAWN_ANEW = ("video.mp4", "replay.html", "report.html", "page.html", "summary.json")
"""With times, or names of folders, of now."""


@pytest.fixture
def place(walked, tmp_path_factory):
    """Make a folder with all that the commands need."""
    swept = tmp_path_factory.mktemp("swept")
    (swept / "mine.toml").write_text(SWEEP)
    words = ["sweep", "mine.toml", "--out", "swept", "--workers", "1"]
    subprocess.run([*COMMAND, *words], cwd=swept, env=OUTSIDE, check=True)
    columns = ("path_length", "distance_walked", "error.quasi_static.farthest")
    row = {"point": 0, "friction": 1.0, "status": "ok"} | dict.fromkeys(columns, 0.1)
    rows = [row, row | {"point": 1, "friction": 0.5}]
    bare = (FOLDER / "hexapod.xml").read_text().replace('model="hexapod"', 'model="b"')

    def make():
        folder = tmp_path_factory.mktemp("here")
        shutil.copytree(walked, folder / "run")
        shutil.copytree(swept / "swept", folder / "swept")
        about = {"asked": {"vary": {"friction": []}}}
        write_table(folder / "run" / "table.parquet", rows, about)
        (folder / "bare.xml").write_text(bare)
        shutil.copy(FOLDER / "scene.xml", folder)
        return folder

    return make


SWEEP = """
scenario = "line"
without = ["identified", "creep_floor"]
[set]
segments = 1
path.goal = [0.002, 0.002, 0]
allow_unstable = true
[grid]
friction = [0.5, 1.0]
"""


def ended(words, folder, moment=None, number=None):
    """How a command ends, perhaps by a signal at a moment: its code, and what it says.

    Without a moment it must come to its own end.
    """
    command, quiet = [*COMMAND, *shlex.split(words)], subprocess.DEVNULL
    given = {"cwd": folder, "env": OUTSIDE, "stdout": quiet, "stderr": subprocess.PIPE}
    with subprocess.Popen(command, **given, text=True) as process:
        try:
            _, said = process.communicate(timeout=moment)
        except subprocess.TimeoutExpired:
            process.send_signal(number)
            _, said = process.communicate(timeout=60)
    assert moment or process.returncode == 0, said
    return process.returncode, said


def is_whole(path):
    """Whether a file can be read to its end."""
    if path.suffix == ".npz":
        with np.load(path) as file:
            return all(file[name].size for name in file.files)
    if path.suffix in (".json", ".jsonl"):
        text = path.read_text()
        lines = [text] if path.suffix == ".json" else text.splitlines()
        return all(json.loads(line) for line in lines)
    if path.suffix == ".toml":
        return bool(tomllib.loads(path.read_text()))
    if path.suffix == ".png":
        with Image.open(path) as picture:
            return picture.convert("RGB").size > (0, 0)
    if path.name == "model.xml":
        return mujoco.MjModel.from_xml_path(str(path)).nq > 0
    if path.suffix in (".html", ".svg"):
        return path.read_text().rstrip().endswith(f"</{path.suffix[1:]}>")
    return path.stat().st_size > 0 or path.suffix in (".lock", ".owner")


def written(folder):
    """Contents of all files in a folder by their names, but for what is drawn anew."""
    paths = [path for path in folder.rglob("*") if path.is_file()]
    kept = [path for path in paths if path.name not in DRAWN_ANEW]
    return {str(path.relative_to(folder)): path.read_bytes() for path in kept}


@pytest.mark.full
@pytest.mark.physics
@pytest.mark.parametrize("number", CODES, ids=lambda number: number.name)
@pytest.mark.parametrize("words", COMMANDS.values(), ids=COMMANDS)
def test_a_command_that_is_ended_leaves_whole_files_and_goes_on(place, words, number):
    first, began = place(), time.monotonic()
    ended(words, first)
    lasts, wanted = time.monotonic() - began, written(first)
    for i in range(MOMENTS):
        folder, moment = place(), 0.1 + lasts * i / MOMENTS
        code, said = ended(words, folder, moment, number)
        if moment > AWAKE:
            assert code in (0, CODES[number])
            assert said.count("stratawalk: error: ") == (code > 0)
        left = [path for path in folder.rglob("*") if path.is_file()]
        parts = [path for path in left if path.name.startswith(".")]
        assert not parts or number == signal.SIGKILL
        assert all(is_whole(path) for path in left if path not in parts)
        for path in parts:
            path.unlink()
        if code and written(folder) != wanted:
            go_on(folder, told(said), words)
        assert written(folder) == wanted


def go_on(folder, told, words):
    """Do what the message says, or where there is none begin anew.

    There is none yet while Python itself starts.
    """
    if told and ": stratawalk " in told[-1]:
        words = told[-1].rpartition(": stratawalk ")[2]
    elif "--out new" in words and "film" not in words:
        shutil.rmtree(folder / "new", ignore_errors=True)
    elif words.startswith("adopt"):  # which overwrites no file
        for made in ("bare.toml", "bare.png"):
            (folder / made).unlink(missing_ok=True)
    ended(words, folder)
    for new in folder.glob("new-2*"):  # what had begun was kept
        old = folder / new.name.replace("-2", "")
        if old.is_dir():
            shutil.rmtree(old)
        new.replace(old)
