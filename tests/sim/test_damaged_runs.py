"""A run folder that was damaged is refused in one line, whatever reads it."""

import io
import json
import re
import shutil
import zipfile

import numpy as np
import pytest

from sim.cli import main
from sim.errors import UsageError
from sim.runs.run import read_run

COMMANDS = {
    "film": ("film", "run", "--to", "0.1"),
    "show": ("show", "run", "--no-browser"),
    "export": ("export", "run", "--format", "csv", "--out", "e.csv"),
    "view": ("view", "run", "--no-browser"),
    "replay": ("view", "run", "--replay", "--no-browser"),
    "compare": ("compare", "run", "run", "--out", "c.html"),
    "cite": ("cite", "run"),
}


def cut(path):
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def rotten(path):
    content = bytearray(path.read_bytes())
    middle = len(content) // 2
    content[middle : middle + 64] = bytes(64)
    path.write_bytes(content)


def emptied(path):
    path.write_bytes(b"")


def removed(path):
    path.unlink()


def arrays(change):
    """Damage to arrays."""

    def damage(path):
        with np.load(path) as file:
            kept = {name: file[name] for name in file}
        change(kept)
        np.savez(path, **kept)

    return damage


def words(change):
    """Damage to a text."""
    return lambda path: path.write_text(change(path.read_text()))


def member(name, content, change=None):
    """An archive of arrays, one of which is replaced by some bytes."""

    def damage(path):
        with zipfile.ZipFile(path) as old:
            kept = {each: old.read(each) for each in old.namelist()}
        kept[name] = content(kept[name])
        with zipfile.ZipFile(path, "w", change or zipfile.ZIP_DEFLATED) as new:
            for each, bytes_ in kept.items():
                new.writestr(each, bytes_)

    return damage


def declaring(shape):
    """An array whose header declares another shape than it has."""

    def content(array):
        header = io.BytesIO()
        given = {"descr": "<f8", "fortran_order": False, "shape": shape}
        np.lib.format.write_array_header_1_0(header, given)
        return header.getvalue() + bytes(1000)

    return content


def without(key):
    """A summary that lacks a key."""
    return words(
        lambda text: json.dumps({k: v for k, v in json.loads(text).items() if k != key})
    )


VIEWS = "film view replay"
ALL = f"{VIEWS} show export compare"
DAMAGES = {
    "states cut": ("trajectory.npz", cut, f"{VIEWS} show export compare"),
    "states rotten": ("trajectory.npz", rotten, f"{VIEWS} show compare"),
    "states of no number": (
        "trajectory.npz",
        arrays(lambda kept: kept.update(qpos=kept["qpos"] * np.nan)),
        ALL,
    ),
    "states beyond all drawing": (
        "trajectory.npz",
        arrays(lambda kept: kept.update(qpos=kept["qpos"] + 1e30)),
        ALL,
    ),
    "states that declare eight gigabytes": (
        "trajectory.npz",
        member("qpos.npy", declaring((10**9,))),
        ALL,
    ),
    "states that declare as many twice below zero": (
        "trajectory.npz",
        member("qpos.npy", declaring((-25, -5))),
        ALL,
    ),
    "states packed in a way of their own": (
        "trajectory.npz",
        member("qpos.npy", bytes, zipfile.ZIP_LZMA),
        "show",
    ),
    "states of fewer moments": (
        "trajectory.npz",
        arrays(lambda kept: kept.update(qpos=kept["qpos"][:-1])),
        ALL,
    ),
    "states of another robot": (
        "trajectory.npz",
        arrays(lambda kept: kept.update(qpos=kept["qpos"][:, 1:])),
        VIEWS,
    ),
    "contacts that are tables": (
        "trajectory.npz",
        arrays(lambda kept: kept.update(contact=kept["contact"][:, None, None])),
        ALL,
    ),
    "poses without yaw": (
        "trajectory.npz",
        arrays(lambda kept: kept.update(achieved_pose=kept["achieved_pose"][:, :2])),
        ALL,
    ),
    "words for states": (
        "trajectory.npz",
        arrays(lambda kept: kept.update(qpos=np.full(len(kept["time"]), "x"))),
        ALL,
    ),
    "a hundred arrays more": (
        "trajectory.npz",
        arrays(lambda kept: kept.update({str(i): kept["time"] for i in range(100)})),
        "show",
    ),
    "states empty": ("trajectory.npz", emptied, f"{VIEWS} show export compare"),
    "states gone": ("trajectory.npz", removed, f"{VIEWS} show export compare"),
    "states without rows": (
        "trajectory.npz",
        arrays(lambda kept: kept.update({k: v[:0] for k, v in kept.items()})),
        f"{VIEWS} show",
    ),
    "commands empty": ("commands.npz", emptied, "view export"),
    "commands of no number": (
        "commands.npz",
        arrays(lambda kept: kept.update(ctrl=kept["ctrl"] * np.nan)),
        "view export",
    ),
    "no commands": (
        "commands.npz",
        arrays(lambda kept: kept.pop("ctrl")),
        "view export show",
    ),
    "a number for commands": (
        "commands.npz",
        arrays(lambda kept: kept.update(ctrl=np.array(1.0))),
        "export",
    ),
    "a summary without its name": ("summary.json", without("scenario"), "show"),
    "a summary of no number": (
        "summary.json",
        words(lambda text: text.replace('"segments": 2', '"segments": NaN')),
        "show",
    ),
    "a summary beyond all numbers": (
        "summary.json",
        words(lambda text: text.replace('"segments": 2', '"segments": 1e999')),
        "show",
    ),
    "a summary of brackets": (
        "summary.json",
        words(lambda text: "[" * 100_000),
        "show",
    ),
    "a summary whose verdict is no text": (
        "summary.json",
        words(lambda text: json.dumps(json.loads(text) | {"verdict": True})),
        "show compare",
    ),
    "a card of a MB": ("model.toml", words(lambda t: t + "#" * 10**6), "show"),
    "a summary of a MB": ("summary.json", words(lambda t: t + " " * 10**6), "show"),
    "a summary cut": ("summary.json", cut, "show export compare"),
    "phases cut": ("flows.csv", cut, f"{VIEWS} show compare"),
    "a phase without end": (
        "flows.csv",
        words(lambda text: re.sub(r"^0,0,[^,]*", "0,0,nan", text, flags=re.MULTILINE)),
        ALL,
    ),
    "phases out of order": (
        "flows.csv",
        words(lambda text: text + text.splitlines()[3] + "\n"),
        ALL,
    ),
    "a phase of no kind": (
        "flows.csv",
        words(lambda text: text.replace(",lift,", ",<b>,", 1)),
        "show cite",
    ),
    "a phase that slips without end": (
        "flows.csv",
        words(lambda text: text.replace(",1\n", "1e300,1\n", 1)),
        "show cite",
    ),
    "phases of other slip": (
        "flows.csv",
        words(lambda text: re.sub(r"[^,]*,1$", "0.001,1", text, flags=re.MULTILINE)),
        "show cite",
    ),
    "a phase of a segment before": (
        "flows.csv",
        words(lambda text: re.sub(r"^5,0,", "5,-1,", text, flags=re.MULTILINE)),
        "show cite",
    ),
    "a phase of a segment that was not planned": (
        "flows.csv",
        words(lambda text: re.sub(r"\n(\d+),1,", r"\n\1,999,", text)),
        "show cite",
    ),
    "a film without end": (
        "scenario.toml",
        words(lambda text: text.replace("playback = 60.0", "playback = 1e-9")),
        "film replay",
    ),
    "a phase of great length": (
        "flows.csv",
        words(lambda text: text + "1" * 200_000 + "\n"),
        f"{VIEWS} show compare",
    ),
    "a model without its start": (
        "model.xml",
        words(lambda text: text.replace('<key name="start"', '<key name="other"')),
        "export",
    ),
    "a card without gait": (
        "model.toml",
        words(lambda text: text.partition("[gait]")[0]),
        f"{VIEWS} show export compare",
    ),
    "versions that are a list": (
        "summary.json",
        words(lambda text: json.dumps(json.loads(text) | {"versions": [1]})),
        "cite",
    ),
    "a scenario that is gone": ("scenario.toml", removed, f"{VIEWS} show compare"),
}
CASES = [
    (name, command) for name, (_, _, by) in DAMAGES.items() for command in by.split()
]


@pytest.mark.physics
@pytest.mark.parametrize(("name", "command"), CASES, ids=map(" by ".join, CASES))
def test_a_damaged_run_is_refused_in_one_line(
    walked, tmp_path, monkeypatch, capsys, name, command
):
    shutil.copytree(walked, tmp_path / "run")
    monkeypatch.chdir(tmp_path)
    file, damage, _ = DAMAGES[name]
    damage(tmp_path / "run" / file)
    assert main(COMMANDS[command]) in (2, 3)
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("stratawalk: error: ")
    assert "run" in line
    assert "a bug of ours" not in line
    assert "[Errno" not in line


@pytest.mark.physics
@pytest.mark.parametrize(
    ("save", "said"),
    [(np.savez, "larger than 0.01 GB"), (np.savez_compressed, "arrays of 0.0")],
)
def test_no_more_is_unpacked_than_may_be_read(folder, monkeypatch, save, said):
    monkeypatch.setattr("sim.runs.arrays.UNPACKED", 10**7)
    run = read_run(folder)
    more = {"more": np.zeros((len(run.time), 2000))}
    save(folder / "trajectory.npz", **run.arrays, **more)
    with pytest.raises(UsageError, match=f"trajectory.npz .*{said}"):
        read_run(folder)
