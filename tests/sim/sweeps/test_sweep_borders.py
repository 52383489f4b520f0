"""Sweeps at the borders of what they take: counts, ends, scales, points and folders."""

import math
import signal
import subprocess
import sys
from contextlib import ExitStack, nullcontext

import numpy as np
import pytest

from sim.cli import main
from sim.errors import UsageError
from sim.folder import csv_text, whole
from sim.sweeps import table, worker_pool
from sim.sweeps.file import (
    Sweep,
    flat,
    grid_blocks,
    left_out,
    list_block,
    read_sweep,
    sobol_block,
)
from sim.sweeps.folder import Shard
from sim.sweeps.sweeping import points_of
from tests.commands import told
from tests.sweeps import write_sweep

MOST_POINTS = 50_000  # of a sweep; checking them takes some ten seconds


def stretched(given, key="friction"):
    ((_, choices),) = grid_blocks({key: given})
    return [value for (value,) in choices]


@pytest.mark.parametrize("count", [1, 2, 5])
def test_a_range_has_as_many_values_as_it_counts(count):
    found = stretched({"from": 0.2, "to": 0.6, "count": count})
    assert found == pytest.approx(np.linspace(0.2, 0.6, count).tolist())
    log = stretched({"from": 0.01, "to": 100.0, "count": count, "scale": "log"})
    assert log == pytest.approx(np.geomspace(0.01, 100.0, count).tolist())
    assert stretched({"from": 0.2, "to": 0.6, "count": 2, "scale": "linear"}) == [
        0.2,
        0.6,
    ]


def test_values_have_twelve_digits_and_whole_settings_none():
    third = stretched({"from": 0.0, "to": 1.0, "count": 4})[1]
    assert third == 0.333333333333
    assert stretched({"from": 1, "to": 10, "count": 4}, "segments") == [1, 4, 7, 10]
    assert stretched({"from": 1, "to": 2, "count": 4}, "segments") == [1, 1, 2, 2]


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"from": 0.1, "to": 0.2, "count": 0}, "whole number from 1 to 50000"),
        ({"from": 0.1, "to": 0.2, "count": 50_001}, "whole number from 1 to 50000"),
        ({"from": 0.1, "to": 0.2, "count": True}, "whole number from 1"),
        ({"from": 0.1, "to": 0.2, "count": 2.0}, "whole number from 1"),
        (
            {"from": 0.0, "to": 1.0, "count": 2, "scale": "log"},
            "from 0.0 to 1.0 is not",
        ),
        ({"from": 0.1, "to": 1.0, "count": 2, "scale": "cubic"}, "scale = 'cubic'"),
        ({"from": 0.1, "to": math.inf, "count": 2}, "no two ends"),
        ({"from": 0.1, "to": "x", "count": 2}, "no two ends"),
        ({"from": 0.1, "to": True, "count": 2}, "no two ends"),
        ({"from": 0.1, "to": 0.2, "count": 2, "step": 1}, "neither a list nor a range"),
        ([], "neither a list nor a range"),
        (0.5, "neither a list nor a range"),
    ],
)
def test_what_is_no_range_is_refused(given, said):
    with pytest.raises(UsageError, match=said):
        list(grid_blocks({"friction": given}))


def test_lists_side_by_side_are_equally_long():
    keys, choices = list_block({"a": [1, 2], "b": [3, 4]})
    assert (keys, choices) == (("a", "b"), [(1, 3), (2, 4)])
    with pytest.raises(UsageError, match="different lengths, a has 1, b has 2: "):
        list_block({"a": [1], "b": [3, 4]})
    assert list_block({"a": [1, 2, 3]})[1] == [(1,), (2,), (3,)]


@pytest.mark.parametrize("count", [1, 2, 3, 8, 9])
def test_samples_are_as_many_as_asked_for_and_lie_in_their_spans(count):
    keys, choices = sobol_block({
        "points": count, "seed": 3, "friction": [0.3, 0.9], "segments": [2, 9],
        "payload.mass": {"from": 0.01, "to": 10.0, "scale": "log"},
    })  # fmt: skip
    assert keys == ("friction", "segments", "payload.mass")
    assert len(choices) == count
    for friction, segments, mass in choices:
        assert 0.3 <= friction <= 0.9
        assert segments in range(2, 10)
        assert isinstance(segments, int)
        assert 0.01 <= mass <= 10.0
    assert sobol_block({"points": count, "friction": [0, 1]}) == sobol_block(
        {"points": count, "seed": 0, "friction": [0, 1]}
    )


def test_logarithmic_samples_are_even_in_their_logarithm():
    _, choices = sobol_block(
        {"points": 256, "a": {"from": 0.01, "to": 100.0, "scale": "log"}}
    )
    logs = np.log10([value for (value,) in choices])
    assert np.mean(logs) == pytest.approx(0.0, abs=0.05)
    assert np.quantile(logs, [0.25, 0.75]) == pytest.approx([-1.0, 1.0], abs=0.05)


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ({"points": 0, "a": [0, 1]}, "points = 0 is not allowed"),
        ({"points": MOST_POINTS + 1, "a": [0, 1]}, "from 1 to 50000"),
        ({"points": 4, "seed": -1, "a": [0, 1]}, "seed = -1"),
        ({"points": 4, "seed": 2**32, "a": [0, 1]}, "from 0 to 4294967295"),
        ({"points": 4}, "no keys are given"),
        ({"points": 4, "a": [0, 1, 2]}, "no two ends"),
        ({"points": 4, "a": [0]}, "no two ends"),
    ],
)
def test_samples_that_cannot_be_drawn_are_refused(table, said):
    with pytest.raises(UsageError, match=said):
        sobol_block(table)


def made(*counts, **parts):
    blocks = tuple(((f"k{n}",), [(v,) for v in range(c)]) for n, c in enumerate(counts))
    return Sweep("s", {}, {}, blocks, (), **parts)


def test_points_are_numbered_with_the_last_key_fastest():
    sweep = made(2, 3, 2)
    assert len(sweep) == 12
    assert sweep.keys == ("k0", "k1", "k2")
    found = [tuple(sweep.varied(point).values()) for point in range(12)]
    assert found == sorted(found)
    assert found[5] == (0, 2, 1)
    assert len(set(found)) == 12


def test_a_sweep_has_fifty_thousand_points_at_most():
    assert len(made(MOST_POINTS)) == 50_000
    with pytest.raises(UsageError, match="50001 points: .* at most 50000 points"):
        made(MOST_POINTS + 1)


@pytest.mark.parametrize(
    "path",
    [
        '[path]\nkind = "table"\nposes = POSES\n',
        '[path]\nkind = "table"\nfile = "p.csv"\n',
        '[path]\nkind = "table"\n[grid.path]\nposes = [POSES]\n',
        '[path]\nkind = "table"\n[grid.path]\nfile = ["p.csv"]\n',
    ],
)
def test_a_sweep_of_a_long_path_has_fewer_points(tmp_path, path):
    """Every point is checked with its whole path, wherever that stands."""
    places = [[0.00001 * n, 0.0, 0.0] for n in range(2000)]
    (tmp_path / "p.csv").write_text(csv_text([("x", "y", "yaw"), *places]))
    many = "[list]\nfriction = { from = 0.5, to = 1.0, count = 5000 }\n"
    (tmp_path / "s.toml").write_text(path.replace("POSES", str(places)) + many)
    with pytest.raises(UsageError, match=r"5000 points: .* at most \d{4} points"):
        points_of(read_sweep(str(tmp_path / "s.toml")), Shard())


def test_tables_are_flattened_but_for_ranges_and_what_has_a_kind():
    table = {
        "a": {"b": 1, "c": {"d": 2}},
        "r": {"from": 0, "to": 1},
        "p": {"kind": "k"},
    }
    assert dict(flat(table)) == {
        "a.b": 1, "a.c.d": 2, "r": {"from": 0, "to": 1}, "p": {"kind": "k"},
    }  # fmt: skip
    assert dict(flat({"r": {"from": 0}})) == {"r.from": 0}


def test_measures_that_are_left_out_are_sorted_and_known():
    given = ["creep_floor", "compliant", "compliant"]
    assert left_out(given) == ("compliant", "creep_floor")
    for given in ("compliant", ["ideal"], 3):
        with pytest.raises(UsageError, match="give a list of identified and compliant"):
            left_out(given)


@pytest.mark.parametrize(
    ("keep", "said"),
    [
        ("points = [0, 3]", ""),
        ("points = [4]", "points = \\[4\\] is not allowed.*from 0 to 3"),
        ("points = [-1]", "from 0 to 3"),
        ("points = [true]", "from 0 to 3"),
        ("points = 2", "from 0 to 3"),
        ("points = [1]\nfilm = 1", "film = 1: \\[keep\\]; give true or false"),
    ],
)
def test_run_folders_are_of_points_that_there_are(tmp_path, keep, said):
    path = tmp_path / "s.toml"
    grid = "[grid]\nfriction = [0.5, 0.6]\nsegments = [2, 3]\n"
    path.write_text(f'scenario = "line"\n{grid}[keep]\n{keep}\n')
    if said:
        with pytest.raises(UsageError, match=said):
            read_sweep(str(path))
        return
    sweep = read_sweep(str(path))
    assert sweep.run_folders == (0, 3)
    assert sweep.filmed is False
    path.write_text(path.read_text().replace("[0, 3]", "[3, 0, 3]\nfilm = true"))
    assert read_sweep(str(path)).run_folders == (0, 3)
    assert read_sweep(str(path)).filmed is True


@pytest.mark.parametrize(
    "address",
    ["x", "foo://127.0.0.1:8786", "inproc://x:1", "http://evil:80", "tcp://a:99999"]
    + ["a:0", "tcp://a:b:80", "::1:8786", "[::1]:0", "tcp://:8786"],
)
def test_an_address_without_a_port_is_refused_before_anything_is_made(
    tmp_path, capsys, address
):
    file = write_sweep(tmp_path, "[grid]\nfriction = [0.5]\n")
    words = ("sweep", file, "--out", tmp_path / "o", "--scheduler", address)
    assert main(list(map(str, words))) == 2
    (line,) = told(capsys.readouterr().err)
    assert line.endswith(f"without a port: {address}; give tcp://HOST:PORT")
    assert not (tmp_path / "o").exists()


def test_a_limit_of_time_and_a_closed_terminal_end_the_sweep_and_not_its_workers(
    monkeypatch,
):
    masks = []

    def cluster(**given):
        masks.append(signal.pthread_sigmask(signal.SIG_BLOCK, []))
        return nullcontext()

    monkeypatch.setattr(worker_pool, "LocalCluster", cluster)
    with ExitStack() as stack:
        worker_pool._local(stack, 1)
    assert masks[0] == {signal.SIGXCPU, signal.SIGHUP}
    assert signal.pthread_sigmask(signal.SIG_BLOCK, []) == set()


def test_what_makes_certificates_is_asked_for_before_anything_is_made(tmp_path):
    out = tmp_path / "out"
    without = "import sys; sys.modules['cryptography'] = None; from sim import start; "
    words = ["sweep", str(write_sweep(tmp_path, "")), "--out", str(out)]
    begin = [sys.executable, "-c", f"{without}sys.exit(start.main())", *words]
    done = subprocess.run(begin, capture_output=True, text=True)
    assert done.returncode == 2
    assert "package 'cryptography' is not installed: the extra 'sweep'" in done.stderr
    assert not out.exists()


def test_a_process_that_workers_are_forked_from_complains_to_nobody():
    """In a program that only names it nothing is muted."""
    begin = "import sys, sim.sweeps.muted; print('complaint', file=sys.stderr)"
    words = {"import multiprocessing.forkserver; ": "", "": "complaint\n"}
    for head, said in words.items():
        done = subprocess.run([sys.executable, "-c", head + begin], capture_output=True)
        assert done.stderr.decode() == said


def test_a_full_disk_is_told_what_a_table_of_many_columns_takes(tmp_path, monkeypatch):
    rows = [{f"column {k}": k / 7 + point for k in range(230)} for point in range(4)]
    asked = []
    monkeypatch.setattr(table, "whole", spied(asked))
    table.write_table(tmp_path / "table.parquet", rows, {})
    assert asked == [
        pytest.approx((tmp_path / "table.parquet").stat().st_size, rel=0.2)
    ]


def spied(asked):
    """The real `whole`, which notes the sizes that it is asked for."""

    def noted(path, size=0, **given):
        asked.append(size)
        return whole(path, size, **given)

    return noted


def test_no_worker_is_begun_in_a_folder_that_is_gone(tmp_path, monkeypatch):
    """They would die as they start, for which memory is blamed."""
    gone = tmp_path / "gone"
    gone.mkdir()
    monkeypatch.chdir(gone)
    gone.rmdir()
    with pytest.raises(FileNotFoundError), ExitStack() as stack:
        worker_pool._local(stack, 1)
