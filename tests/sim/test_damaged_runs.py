"""A run folder that was damaged is refused in one line, whatever reads it."""

import json
import shutil

import numpy as np
import pytest

from sim.cli import main

COMMANDS = {
    "film": ("film", "run", "--to", "0.1"),
    "show": ("show", "run", "--no-browser"),
    "export": ("export", "run", "--format", "csv", "--out", "e.csv"),
    "view": ("view", "run", "--no-browser"),
    "replay": ("view", "run", "--replay", "--no-browser"),
    "compare": ("compare", "run", "run", "--out", "c.html"),
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


def without(key):
    """A summary that lacks a key."""
    return words(
        lambda text: json.dumps({k: v for k, v in json.loads(text).items() if k != key})
    )


VIEWS = "film view replay"
DAMAGES = {
    "states cut": ("trajectory.npz", cut, f"{VIEWS} show export compare"),
    "states rotten": ("trajectory.npz", rotten, VIEWS),
    "states empty": ("trajectory.npz", emptied, f"{VIEWS} show export compare"),
    "states gone": ("trajectory.npz", removed, f"{VIEWS} show export compare"),
    "states without rows": (
        "trajectory.npz",
        arrays(lambda kept: kept.update(time=kept["time"][:0])),
        f"{VIEWS} show",
    ),
    "commands empty": ("commands.npz", emptied, "view export"),
    "commands of no number": (
        "commands.npz",
        arrays(lambda kept: kept.update(ctrl=kept["ctrl"] * np.nan)),
        "export",
    ),
    "a number for commands": (
        "commands.npz",
        arrays(lambda kept: kept.update(ctrl=np.array(1.0))),
        "export",
    ),
    "a summary without its name": ("summary.json", without("scenario"), "show"),
    "a summary cut": ("summary.json", cut, "show export compare"),
    "phases cut": ("flows.csv", cut, f"{VIEWS} show compare"),
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


BOMB = '<worldbody><replicate count="300000"><geom size="1"/></replicate></worldbody>'


@pytest.mark.physics
@pytest.mark.full
@pytest.mark.parametrize("command", ["film", "export"])
def test_the_model_of_a_run_may_be_a_bomb(
    walked, tmp_path, monkeypatch, capsys, command
):
    shutil.copytree(walked, tmp_path / "run")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "run" / "model.xml").write_text(f"<mujoco>{BOMB}</mujoco>")
    assert main(COMMANDS[command]) == 3
    assert "too large: run/model.xml; " in capsys.readouterr().err
