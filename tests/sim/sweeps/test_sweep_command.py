"""`stratawalk sweep`: its table by real workers, its refusals, and going on."""

import json
import os
import re
import shutil
import signal
import subprocess
import time

import duckdb
import pandas
import polars
import psutil
import pytest

from sim.cli import main
from sim.simulation import simulate
from sim.sweeps.file import read_sweep
from sim.sweeps.worker_pool import numbers
from tests.commands import COMMAND, OUTSIDE, told
from tests.sweeps import stratawalk, walked_here, write_sweep

pytestmark = pytest.mark.physics
VARIES = '[grid]\nfriction = [0.4, 1.0]\nstance = ["centred", "paper"]\n'


@pytest.fixture(scope="module")
def swept(tmp_path_factory):
    """A finished sweep of four points: its file and its folder."""
    folder = tmp_path_factory.mktemp("swept")
    file = write_sweep(folder, VARIES)
    done = stratawalk("sweep", file, "--out", folder / "out", "--workers", 1, "--json")
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    assert (told["points"], told["failed"], told["walked"]) == (4, 0, 4)
    assert sum(told["verdicts"].values()) == 4
    return file, folder / "out"


@pytest.fixture
def again(swept, tmp_path):
    """A copy of the sweep's folder, to be spoilt, and its file."""
    return swept[0], shutil.copytree(swept[1], tmp_path / "copy")


def test_the_table_opens_in_pandas_polars_and_duckdb(swept):
    path = str(swept[1] / "table.parquet")
    rows = pandas.read_parquet(path)
    assert rows["point"].tolist() == [0, 1, 2, 3]
    assert rows["friction"].tolist() == [0.4, 0.4, 1.0, 1.0]
    assert rows["stance"].tolist() == ["centred", "paper"] * 2
    assert rows["status"].tolist() == ["ok"] * 4
    assert not [name for name in rows if name.startswith("timing")]
    column = "error.quasi_static.position"
    theirs = polars.read_parquet(path)[column].to_list()
    assert theirs == rows[column].tolist()
    found = duckdb.sql(f"select \"{column}\" from '{path}' order by point").fetchall()
    assert [value for (value,) in found] == theirs


def test_a_point_has_the_numbers_of_a_run_with_its_settings(swept):
    sweep = read_sweep(str(swept[0]))
    rows = pandas.read_parquet(swept[1] / "table.parquet")
    summary = simulate(sweep.at(3), without=sweep.without).summary
    wanted = {k: v for k, v in numbers(summary) if isinstance(v, float)}
    assert {name: rows[name][3] for name in wanted} == wanted


def test_what_is_missing_is_walked_again_to_the_same_bytes(again):
    file, folder = again
    wanted = (folder / "table.parquet").read_bytes()
    (folder / "table.parquet").unlink()
    lines = (folder / "ledger.jsonl").read_bytes().splitlines(keepends=True)
    (folder / "ledger.jsonl").write_bytes(lines[2] + lines[0] + lines[3][:50])
    done = walked_here("sweep", file, "--out", folder, "--workers", 1, "--resume")
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("4 points, 2 of them done before\n")
    assert "4 points, 2 walked now, 0 failed\narrived " in done.stdout
    assert (folder / "table.parquet").read_bytes() == wanted


def test_going_on_with_a_finished_sweep_walks_nothing(again):
    file, folder = again
    done = walked_here("sweep", file, "--out", folder, "--resume")
    assert (done.returncode, told(done.stderr)) == (0, [])
    assert "4 points, 0 walked now" in done.stdout


def test_an_existing_sweep_is_not_begun_again(swept):
    done = walked_here("sweep", swept[0], "--out", swept[1])
    assert done.returncode == 2
    assert "already exists" in done.stderr
    assert "--resume" in done.stderr


def test_another_sweep_in_its_folder_is_refused_with_what_differs(again, tmp_path):
    _, folder = again
    other = write_sweep(tmp_path, VARIES.replace("0.4", "0.5"), "other")
    done = walked_here("sweep", other, "--out", folder, "--resume")
    assert done.returncode == 2
    assert "friction: [0.4, 1.0], now [0.5, 1.0]" in done.stderr
    assert "--force-mix" in done.stderr


def test_mixing_keeps_equal_points_and_walks_the_others(again, tmp_path):
    _, folder = again
    other = write_sweep(tmp_path, VARIES.replace("0.4", "0.5"), "other")
    words = ("sweep", other, "--out", folder)
    done = walked_here(*words, "--resume", "--force-mix")
    assert done.returncode == 0, done.stderr
    assert "4 points, 2 walked now" in done.stdout
    rows = pandas.read_parquet(folder / "table.parquet")
    assert rows["friction"].tolist() == [0.5, 0.5, 1.0, 1.0]


@pytest.mark.parametrize("key", ["mujoco", "code"])
def test_a_sweep_begun_with_other_software_is_refused(again, key):
    file, folder = again
    about = json.loads((folder / "sweep.json").read_text())
    now = about["software"][key]
    about["software"][key] = "older"
    (folder / "sweep.json").write_text(json.dumps(about))
    done = walked_here("sweep", file, "--out", folder, "--resume")
    assert done.returncode == 2
    assert f'{key}: "older", now "{now}"' in done.stderr


def test_a_ledger_with_another_number_makes_no_table(again, capsys):
    file, folder = again
    ledger, table = folder / "ledger.jsonl", folder / "table.parquet"
    before = table.read_bytes()
    ledger.write_text(re.sub(r'("path_length": )', r"\g<1>1", ledger.read_text()))
    going_on = ["sweep", str(file), "--out", str(folder), "--resume"]
    for words in (going_on, ["merge", str(folder)]):
        assert main(words) == 2
        said = capsys.readouterr().err
        assert "line 1 is not as a sweep wrote it, it was changed since: " in said
        assert str(ledger) in said
    assert table.read_bytes() == before


NOWHERE = {"kind": "line", "goal": [0.0, 0.0, 0.0]}
ABOUT = {"scenario": {}, "set": {}, "vary": {}, "without": []}


@pytest.mark.parametrize(
    "about",
    [
        {"asked": {}, "software": {}},
        {"asked": 5, "software": {}},
        {"asked": ABOUT, "software": 5},
        {"asked": ABOUT | {"vary": {"friction": 5}}, "software": {}},
        {"asked": ABOUT | {"vary": {"a with b": [[1]]}}, "software": {}},
        {
            "asked": ABOUT | {"vary": dict.fromkeys("abc", [*range(101)])},
            "software": {},
        },
        {"asked": ABOUT | {"without": ["all"]}, "software": {}},
        {"asked": ABOUT, "software": {"python": float("nan")}},
        {"asked": ABOUT, "software": {"python": "\udcff"}},
        {"asked": ABOUT | {"scenario": {"path": NOWHERE}}, "software": {}},
        [],
    ],
)
def test_what_no_sweep_has_written_is_not_merged(tmp_path, capsys, about):
    (tmp_path / "sweep.json").write_text(json.dumps(about))
    (tmp_path / "ledger.jsonl").write_text("")
    assert main(["merge", str(tmp_path)]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert len(line) < 600
    assert not (tmp_path / "table.parquet").exists()


@pytest.fixture(scope="module")
def failing(tmp_path_factory):
    """A sweep of which every second point has no plan."""
    folder = tmp_path_factory.mktemp("failing")
    varies = "[grid]\ndegree = [1, 2]\n[keep]\npoints = [1]\n"
    file = write_sweep(folder, varies, "failing")
    done = walked_here("sweep", file, "--out", folder / "out")
    return folder / "out", done


def test_failed_points_have_reasons_and_the_others_their_numbers(failing):
    folder, done = failing
    assert done.returncode == 8
    assert "1 of 2 points failed" in done.stderr
    rows = pandas.read_parquet(folder / "table.parquet")
    assert rows["status"][1] == "ok"
    assert "degree" in rows["status"][0]
    assert rows["error.goal.position"].notna().tolist() == [False, True]


def test_a_sweep_of_failures_has_a_table_of_reasons(tmp_path):
    file = write_sweep(
        tmp_path, "[grid]\nfriction = [0.5, 1.0]\n[list]\ndegree = [1]\n"
    )
    done = walked_here("sweep", file, "--out", tmp_path / "out")
    assert done.returncode == 8
    assert "2 of 2 points failed" in done.stderr
    rows = pandas.read_parquet(tmp_path / "out" / "table.parquet")
    assert all("degree" in status for status in rows["status"])
    assert all(status in done.stdout for status in rows["status"])


def test_chosen_points_have_run_folders(failing):
    folder, _ = failing
    (kept,) = (folder / "runs").iterdir()
    assert kept.name == "point-00001"
    summary = json.loads((kept / "summary.json").read_text())
    rows = pandas.read_parquet(folder / "table.parquet")
    position = summary["error"]["goal"]["position"]
    assert rows["error.goal.position"][1] == position
    assert rows["verdict"][1] == summary["verdict"]
    made = {name for name, found in summary["predicted"].items() if found}
    assert made == {"ideal", "quasi_static"}  # without those that the sweep leaves out


def test_a_finished_sweep_names_the_command_that_reads_its_table(failing):
    folder, done = failing
    lines = [
        f"table   {folder / 'table.parquet'}",
        f"next    stratawalk study {folder}",
    ]
    assert done.stdout.splitlines()[-2:] == lines


def test_an_unknown_robot_is_refused_before_anything_is_made(tmp_path):
    file = write_sweep(tmp_path, '[grid]\nrobot = ["hexapod", "hexpod"]')
    done = walked_here("sweep", file, "--out", tmp_path / "out")
    assert done.returncode == 2
    assert "did you mean 'hexapod'" in done.stderr
    assert not (tmp_path / "out").exists()


def test_shards_are_merged_to_the_bytes_of_the_whole(swept, tmp_path):
    file, whole = swept
    alone, beside = tmp_path / "a", tmp_path / "b"
    for number, folder in ((1, alone), (2, beside)):
        shard = ("--shard", f"{number}/2")
        done = walked_here("sweep", file, "--out", folder, *shard)
        assert done.returncode == 0, done.stderr
        on = f"next    once all parts are walked: stratawalk merge {folder}"
        assert done.stdout.splitlines()[-1] == on
        rows = pandas.read_parquet(folder / f"table-{number}-of-2.parquet")
        assert rows["point"].tolist() == [number - 1, number + 1]
    lacking = walked_here("merge", alone)
    assert lacking.returncode == 2
    assert "or were walked with other files of the robot: 1, 3: " in lacking.stderr
    on = f"stratawalk sweep FILE.toml --out {alone} --shard 2/2 --resume"
    assert on in lacking.stderr
    done = walked_here("merge", alone, beside, "--out", tmp_path / "both")
    assert done.returncode == 0, done.stderr
    wanted = (whole / "table.parquet").read_bytes()
    assert (tmp_path / "both" / "table.parquet").read_bytes() == wanted
    going_on = walked_here("sweep", file, "--out", tmp_path / "both", "--resume")
    assert "4 points, 0 walked now" in going_on.stdout


def test_only_shards_of_one_sweep_are_merged(swept, failing):
    done = walked_here("merge", swept[1], failing[0], "--out", swept[1].parent / "x")
    assert done.returncode == 2
    assert "not of one sweep" in done.stderr


def test_an_unknown_number_of_a_shape_is_refused_before_anything_is_made(tmp_path):
    file = write_sweep(tmp_path, "[grid]\ngeometry.kapa = [0.5]")
    done = walked_here("sweep", file, "--out", tmp_path / "out")
    assert done.returncode == 2
    assert "did you mean 'kappa'" in done.stderr
    assert not (tmp_path / "out").exists()


def test_a_sweep_that_is_interrupted_says_how_far_it_is_and_how_to_go_on(tmp_path):
    """As by a terminal that closes: all of its processes are told."""
    varies = "[list]\nhold = [0.1, 60.0]\ntimestep = [0.002, 0.0001]\n"  # minutes
    file = write_sweep(tmp_path, varies)
    file.write_text(file.read_text().replace("timestep = 0.002\nhold = 0.1\n", "", 1))
    ledger = tmp_path / "out" / "ledger.jsonl"
    words = [*COMMAND, "sweep", file, "--out", tmp_path / "out", "--workers", "1"]
    process = subprocess.Popen(
        words, env=OUTSIDE, stderr=subprocess.PIPE, text=True, start_new_session=True
    )
    while process.poll() is None and not (ledger.exists() and ledger.stat().st_size):
        time.sleep(0.05)
    time.sleep(1.0)  # until the line is on the disk, and its point counted
    workers = psutil.Process(process.pid).children(recursive=True)
    os.killpg(process.pid, signal.SIGHUP)
    _, said = process.communicate(timeout=30)
    assert workers
    assert not psutil.wait_procs(workers, timeout=30)[1]
    assert process.returncode == 129
    (line,) = told(said)
    on = f"stratawalk sweep {file} --out {tmp_path / 'out'} --workers 1 --resume"
    assert f"1 of 2 points are done and kept in {tmp_path / 'out'}; " in line
    assert line.endswith(f"go on: {on}")
