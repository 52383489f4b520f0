"""Files that are none: pipes would be waited for, and devices never end."""

import fcntl
import os
import shutil
import socket

import pytest

from models.description.robot import FOLDER
from sim.cli import main

KINDS = ("a pipe", "a device", "a socket", "a link to itself")
TABLE = '[path]\nkind = "table"\nfile = "a.csv"\n'


def make(kind, path):
    """Make what is no file."""
    match kind:
        case "a pipe":
            os.mkfifo(path)
        case "a device":
            path.symlink_to("/dev/zero")
        case "a socket":
            with socket.socket(socket.AF_UNIX) as end:
                end.bind(path.name)  # a whole path may be too long for one
        case "a link to itself":
            path.symlink_to(path.name)


def robot(folder):
    """The shipped hexapod as a user's own."""
    for file in ("hexapod.xml", "hexapod.toml", "scene.xml"):
        shutil.copy(FOLDER / file, folder / file.replace("hexapod", "mine"))


NAMED = {
    "a scenario": ("mine.toml", ("run", "mine.toml"), 2),
    "a plan's scenario": ("mine.toml", ("plan", "mine.toml"), 2),
    "a system": ("mine.toml", ("check", "mine.toml"), 2),
    "a saved plan": ("mine.json", ("plan", "mine.json"), 6),
    "a table of poses": ("a.csv", ("plan", "table.toml"), 2),
    "a sweep": ("mine.toml", ("sweep", "mine.toml", "--out", "out"), 2),
    "a study": ("mine.parquet", ("study", "mine.parquet"), 2),
    "a card": ("mine.toml", ("robots", "mine.xml"), 3),
    "a robot": ("other.xml", ("robots", "other.xml"), 2),
    "what is to be adopted": ("a.urdf", ("adopt", "a.urdf"), 2),
    "a folder to adopt from": ("a.xml", ("adopt", "."), 2),
    "a run folder": ("out", ("run", "line", "--out", "out"), 2),
    "a plan to be saved": ("out.json", ("plan", "biped", "--save", "out.json"), 2),
    "a run to be filmed": ("out", ("film", "out"), 2),
    "a motion": ("a.csv", ("play", "hexapod", "a.csv", "--no-video"), 2),
    "answers": ("a.txt", ("calibrate", "hexapod", "--answers", "a.txt"), 2),
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", NAMED)
def test_what_is_no_file_is_refused_and_not_waited_for(
    tmp_path, monkeypatch, capsys, kind, name
):
    monkeypatch.chdir(tmp_path)
    file, words, code = NAMED[name]
    robot(tmp_path)
    (tmp_path / "mine.toml").unlink() if file == "mine.toml" else None
    if words[0] == "adopt":
        (tmp_path / "mine.xml").unlink()
        (tmp_path / "scene.xml").unlink()
    (tmp_path / "table.toml").write_text(TABLE)
    (tmp_path / "calibration").mkdir()
    (tmp_path / "calibration" / "joint-12.png").touch()  # all joints are drawn already
    make(kind, tmp_path / file)
    assert main(words) == code
    lines = capsys.readouterr().err.splitlines()
    (line,) = (line for line in lines if not line.startswith("stratawalk: notice: "))
    assert line.startswith("stratawalk: error: ")


READERS = {
    "film": ("film", "run", "--to", "0.1"),
    "show": ("show", "run", "--no-browser"),
    "export": ("export", "run", "--format", "csv", "--out", "e.csv"),
    "compare": ("compare", "run", "run", "--out", "c.html"),
    "view": ("view", "run", "--no-browser"),
}
READ = {
    "scenario.toml": "film show export compare view",
    "model.toml": "film show export compare view",
    "model.xml": "film export view",
    "trajectory.npz": "film show export compare view",
    "commands.npz": "export view",
    "flows.csv": "film show compare view",
    "summary.json": "show export compare",
}
PIPES = [(file, command) for file, by in READ.items() for command in by.split()]


@pytest.mark.physics
@pytest.mark.parametrize(("file", "command"), PIPES, ids=map(" by ".join, PIPES))
def test_a_pipe_in_a_run_folder_is_not_waited_for(
    walked, tmp_path, monkeypatch, capsys, file, command
):
    shutil.copytree(walked, tmp_path / "run")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "run" / file).unlink()
    os.mkfifo(tmp_path / "run" / file)
    assert main(READERS[command]) in (2, 3)
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("stratawalk: error: ")
    assert "a bug of ours" not in line


ZERO = "a\\u0000"
NAMES = {
    "a robot with a zero byte": f'robot = "{ZERO}.xml"\n[path]\ngoal = [0.1, 0, 0]\n',
    "a table with a zero byte": TABLE.replace("a.csv", f"{ZERO}.csv"),
    "a scenario with a zero byte": f'name = "{ZERO}"\n[path]\ngoal = [0.1, 0, 0]\n',
    "a table that is a link to itself": TABLE.replace("a.csv", "self.csv"),
    "a robot that is a link to itself": 'robot = "self.xml"\n[path]\ngoal = [1, 0, 0]',
    "a table of great length": TABLE.replace("a.csv", f"{'a' * 5000}.csv"),
    "a robot of great length": f'robot = "{"a" * 5000}.xml"\n[path]\ngoal = [1, 0, 0]',
    "a table of one long word": TABLE.replace("a.csv", "long.csv"),
}


@pytest.mark.parametrize("text", NAMES.values(), ids=NAMES)
def test_impossible_names_are_refused_in_one_line(tmp_path, monkeypatch, capsys, text):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.toml").write_text(text)
    (tmp_path / "long.csv").write_text(f"x,y,yaw\n{'1' * 200_000},0,0\n")
    for name in ("self.csv", "self.xml"):
        (tmp_path / name).symlink_to(name)
    assert main(["plan", "mine.toml"]) in (2, 6)
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("stratawalk: error: ")


def test_files_that_no_one_has_written_are_not_read(tmp_path, monkeypatch, capsys):
    """A file may be of any size without taking any room."""
    monkeypatch.chdir(tmp_path)
    robot(tmp_path)
    for name, words, code in (
        ("mine.toml", ("plan", "mine.toml"), 2),
        ("mine.toml", ("robots", "mine.xml"), 3),
        ("a.csv", ("plan", "table.toml"), 2),
        ("mine.json", ("plan", "mine.json"), 6),
    ):
        (tmp_path / "table.toml").write_text(TABLE)
        with (tmp_path / name).open("w") as file:
            file.truncate(10**12)
        assert main(words) == code
        (line,) = capsys.readouterr().err.splitlines()
        assert "larger than" in line


@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_a_pipe_that_takes_a_part_is_a_fault_of_files(stratawalk, unbuffered):
    reader, writer = os.pipe()
    fcntl.fcntl(writer, fcntl.F_SETPIPE_SZ, 4096)  # less than the page of help has
    os.set_blocking(writer, False)
    try:
        done = stratawalk("help", "run", stdout=writer, PYTHONUNBUFFERED=unbuffered)
    finally:
        os.close(writer)
        os.close(reader)
    assert (done.returncode, done.stderr.count("\n")) == (6, 1)
