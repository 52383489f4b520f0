"""Rows of `scripts/torture.py` that concern sweeps and their workers, and viewers."""

from __future__ import annotations

from scripts.torture_inputs import CARD, GO, HEXAPOD, SCENE, Row, both, file

SWEEP = """scenario = "line"
without = ["identified", "creep_floor"]
[set]
segments = 1
path.goal = [0.002, 0.002, 0]
timestep = 0.002
hold = 0.1
swing_speed = 2.0
swing_acceleration = 20.0
allow_unstable = true
"""
DEADLY = """
import importlib.abc, importlib.util, os, signal, sys

class Deadly(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path, target=None):
        if name != "sim.sweeps.worker":
            return None
        sys.meta_path.remove(self)
        spec = importlib.util.find_spec(name)
        execute = spec.loader.exec_module
        def poisoned(module):
            execute(module)
            walk = module.simulate
            def simulate(scenario, **options):
                if scenario.friction == 0.666:
                    os.kill(os.getpid(), signal.SIGSEGV)
                return walk(scenario, **options)
            module.simulate = simulate
        spec.loader.exec_module = poisoned
        return spec

sys.meta_path.insert(0, Deadly())
"""
"""As `sitecustomize` of a process: a point of friction 0.666 kills its worker."""

CLUSTER = """daemon() {
  kind=$1
  shift
  python -m distributed.cli.dask_$kind --host 127.0.0.1 --no-dashboard \\
    "$@" >/dev/null 2>&1 &
}
daemon scheduler --port 0 --scheduler-file cluster.json
until [ -s cluster.json ]; do sleep 0.1; done
mkdir -p other/mujoco-4.0.9.dist-info
printf 'Metadata-Version: 2.1\\nName: mujoco\\nVersion: 4.0.9\\n' \\
  >other/mujoco-4.0.9.dist-info/METADATA
export PYTHONPATH=$PWD/other:$PYTHONPATH
daemon worker --scheduler-file cluster.json --nworkers 1 --local-directory scratch
sed -n 's/.*"address": "\\(.*\\)".*/\\1/p' cluster.json
"""
"""A scheduler and a worker that has another MuJoCo; prints their address."""

COMMAND = "stratawalk sweep mine.toml --out a"
TESTS = "test_sweep_command.py::"
KILLED = "test_sweep_killed.py::test_a_sweep_survives_being_killed"


def sweep(varies: str, settings: str = "") -> str:
    """A sweep of a short walk: what varies, and further settings."""
    return f"{SWEEP}{settings}{varies}"


FRICTIONS = file("mine.toml", sweep("[grid]\nfriction = [0.4, 0.6, 0.8, 1.0]\n"))
MANY = file(
    "mine.toml", sweep("[grid]\nfriction = { from = 0.2, to = 1.0, count = 400 }\n")
)
BEGUN = "until [ -s a/ledger.jsonl ]; do sleep 0.1; done"
OLDER = """sed -i 's/"mujoco": "[^"]*"/"mujoco": "3.9.0"/'"""
FULL = HEXAPOD.replace("<keyframe>", '<size memory="20K"/><keyframe>')

SWEEPS = (
    Row(23, "a robot that the engine cannot run, among others",
        f"{COMMAND} --workers 2", 8,
        f"{TESTS}test_failed_points_have_reasons_and_the_others_their_numbers",
        both(file("mine.toml", sweep('[grid]\nrobot = ["hexapod", "full.xml"]\n')),
             file("full.xml", FULL), file("full.toml", CARD),
             file("scene.xml", SCENE)), says="1 of 2 points failed"),
    Row(24, "every point of a sweep fails", COMMAND, 8,
        f"{TESTS}test_a_sweep_of_failures_has_a_table_of_reasons",
        file("mine.toml", sweep("[grid]\nfriction = [0.5, 1.0]\n", "degree = 1\n")),
        says="2 of 2 points failed"),
    Row(25, "a point that crashes its worker",
        f"PYTHONPATH=$PWD:$PYTHONPATH {COMMAND}", 8,
        "test_worker_pool.py::test_a_point_that_kills_its_worker_harms_no_other",
        both(file("mine.toml", sweep("[grid]\nfriction = [0.5, 0.666, 0.8]\n")),
             file("sitecustomize.py", DEADLY)), says="1 of 3 points failed"),
    Row(26, "a sweep that is killed",
        f"({COMMAND} & {BEGUN}; kill -9 $!) >/dev/null 2>&1; "
        f"{COMMAND} --resume && stratawalk sweep mine.toml --out b >/dev/null && "
        "cmp a/table.parquet b/table.parquet", 0, KILLED, FRICTIONS,
        says="4 points"),
    Row(27, "two sweeps in one folder",
        f"{COMMAND} >/dev/null 2>&1 & {BEGUN}; {COMMAND} --resume", 6,
        "test_ledger.py::test_a_second_process_is_refused_and_told_of_the_first",
        MANY, says="is working on this sweep"),
    Row(28, "another sweep in the folder of one",
        f"{COMMAND} >/dev/null 2>&1 && sed -i s/0.4/0.5/ mine.toml && "
        f"{COMMAND} --resume", 2,
        f"{TESTS}test_another_sweep_in_its_folder_is_refused_with_what_differs",
        FRICTIONS, says="--force-mix"),
    Row(28, "the same, mixed",
        f"{COMMAND} >/dev/null 2>&1 && sed -i s/0.4/0.5/ mine.toml && "
        f"{COMMAND} --resume --force-mix", 0,
        f"{TESTS}test_mixing_keeps_equal_points_and_walks_the_others",
        FRICTIONS, says="1 walked now"),
    Row(28, "other software than a sweep was begun with",
        f"{COMMAND} >/dev/null 2>&1 && {OLDER} a/sweep.json && {COMMAND} --resume", 2,
        f"{TESTS}test_a_sweep_begun_with_other_software_is_refused",
        FRICTIONS, says='mujoco: "3.9.0", now "4.0.0"'),
    Row(29, "Ctrl-C during a sweep",
        f"sh -c '{BEGUN}; kill -INT $PPID' & exec {COMMAND}", 130,
        f"{TESTS}test_a_sweep_that_is_interrupted_says_how_far_it_is_and_how_to_go_on",
        MANY, says="go on with --resume"),
    Row(44, "a worker with another MuJoCo", f"{COMMAND} --scheduler $(sh cluster.sh)",
        8, "test_worker_pool.py::test_workers_with_another_mujoco_get_no_points",
        both(FRICTIONS, file("cluster.sh", CLUSTER)), says="4.0.9"),
)  # fmt: skip

VIEWERS = (
    Row(43, "a viewer, until Ctrl-C",
        f"stratawalk run line {GO} --out a >/dev/null; stratawalk view a >said & "
        "until grep -q ssh said; do sleep 0.1; done; kill -INT $!; wait $! && cat said",
        0,
        "test_browser.py::test_the_viewer_shows_the_walk_to_this_machine_alone",
        says="ssh -L"),
    Row(43, "a viewer for everybody",
        f"stratawalk run line {GO} --out a >/dev/null && "
        "stratawalk view a --host 0.0.0.0", 2,
        "test_browser.py::test_others_may_connect_only_if_that_is_wanted",
        says="--public"),
)  # fmt: skip
