"""Ctrl-C and SIGTERM are answered within a second, whatever the command is doing."""

import os
import signal
import subprocess
import sys
import threading

import mujoco
import pytest

from planner.support.files import whole_file
from planner.support.stopping import limited, tick
from sim import cli, interruption
from sim.endings import ENDS
from sim.errors import ExitCode, exit_code

BUSY = """
import os, sys, threading
import mujoco
from pathlib import Path
from planner.support import limited, tick, whole_file
from sim import interruption

interruption.watch()
model = mujoco.MjModel.from_xml_string("<mujoco/>")
data = mujoco.MjData(model)
with interruption.listening(), whole_file(Path("a.txt")) as part, limited(60.0):
    part.write_text("half")
    tick("8 segments")
    send = threading.Timer(0.5, os.kill, (os.getpid(), int(sys.argv[1])))
    send.start()  # when the engine has been at work for long
    mujoco.mj_step(model, data, nstep=10**9)
"""


@pytest.fixture
def listening():
    """Answer signals as the command does, until the test is over."""
    with interruption.listening():
        yield


@pytest.mark.parametrize("number", ENDS)
def test_a_long_step_of_a_library_is_ended_with_the_best_so_far(tmp_path, number):
    done = subprocess.run(
        [sys.executable, "-c", BUSY, str(int(number))],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": os.getcwd()},
        capture_output=True,
        text=True,
    )
    assert done.returncode == ENDS[number][0]
    (line,) = done.stderr.splitlines()
    assert "during a long step, planning had come to 8 segments; " in line
    assert list(tmp_path.iterdir()) == []


def planned_with_a_library_of_its_own_errors():
    with limited(60.0):
        tick("3 segments")
        try:
            os.kill(os.getpid(), signal.SIGTERM)
        except KeyboardInterrupt:
            raise ImportError("initialization failed") from None


def test_an_interruption_that_a_library_makes_its_own_error_is_still_one(listening):
    with pytest.raises(ImportError) as noted:
        planned_with_a_library_of_its_own_errors()
    stop = interruption.meant(noted.value)
    assert isinstance(stop, interruption.Terminated)
    assert stop.__notes__ == ["planning had come to 3 segments"]


@pytest.mark.parametrize(
    "error",
    [
        ImportError("no module named so"),
        ValueError("Could not allocate memory"),
        mujoco.FatalError("unknown object"),
    ],
    ids=repr,
)
def test_other_errors_mean_themselves(listening, error):
    assert interruption.meant(error) is error


def test_memory_that_the_engine_lacks_is_memory(listening):
    error = mujoco.FatalError("Could not allocate memory")
    assert exit_code(interruption.meant(error)) == ExitCode.SIMULATION


def test_a_search_raises_again_what_a_library_swallowed(listening):
    with pytest.raises(KeyboardInterrupt):
        os.kill(os.getpid(), signal.SIGINT)
    with pytest.raises(KeyboardInterrupt):
        tick()


def test_a_second_signal_ends_at_once(tmp_path):
    program = (
        "import os, signal\n"
        "from sim import interruption\n"
        "with interruption.listening():\n"
        "    try: os.kill(os.getpid(), signal.SIGINT)\n"
        "    finally: os.kill(os.getpid(), signal.SIGINT)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program],
        env=os.environ | {"PYTHONPATH": os.getcwd()},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 130
    (line,) = done.stderr.splitlines()
    assert "interrupted: Ctrl-C for the second time; " in line


@pytest.mark.parametrize(
    ("number", "code"),
    [
        (signal.SIGINT, 0),
        (signal.SIGTERM, 143),
        (signal.SIGHUP, 129),
        (signal.SIGXCPU, 152),
    ],
)
def test_a_viewer_is_ended_by_ctrl_c_and_stopped_by_other_signals(
    tmp_path, monkeypatch, capsys, number, code
):
    def serve(*given):
        os.kill(os.getpid(), number)

    monkeypatch.setattr("sim.viewing.web.serve", serve)
    assert cli.main(["view", str(tmp_path)]) == code
    told = capsys.readouterr().err.strip()
    assert told.startswith(f"stratawalk: error: {ENDS[number][1]}; " if code else "")
    assert bool(told) == bool(code)


LIBRARY = """
import os, signal
from sim import cli, interruption
from sim.endings import ENDS

def execute(words):
    os.kill(os.getpid(), signal.SIGINT)

cli._execute = execute
before = [signal.getsignal(number) for number in ENDS]
assert cli.main(["scenarios"]) == 130
assert before == [signal.getsignal(number) for number in ENDS]
try:
    os.kill(os.getpid(), signal.SIGINT)
finally:
    print("cleaned up")
"""


def test_a_program_that_calls_the_command_answers_the_next_signal_itself():
    done = subprocess.run(
        [sys.executable, "-c", LIBRARY],
        env=os.environ | {"PYTHONPATH": os.getcwd()},
        capture_output=True,
        text=True,
    )
    assert done.stdout == "cleaned up\n"
    assert done.stderr.rstrip().endswith("KeyboardInterrupt")


def test_the_command_may_be_called_from_any_thread(capsys):
    codes = []
    thread = threading.Thread(target=lambda: codes.append(cli.main(["scenarios"])))
    thread.start()
    thread.join()
    assert codes == [0]


DROPPED = """
import os, signal, sys, time, weakref
from sim import interruption

class Anything: pass

interruption.watch()
with interruption.listening():
    one = Anything()
    seen = weakref.ref(one, lambda _: os.kill(os.getpid(), signal.SIGTERM))
    del one  # what the signal raises here goes no further
    time.sleep(10)
"""


def test_a_signal_whose_exception_python_drops_ends_the_command_without_a_traceback():
    words = [sys.executable, "-c", DROPPED]
    done = subprocess.run(words, capture_output=True, text=True, timeout=9)
    assert done.returncode == ExitCode.TERMINATED
    (line,) = done.stderr.splitlines()
    assert line.startswith("stratawalk: error: terminated: SIGTERM during a long step")


ANSWERED = """    stopping.answer(stopping.unanswered_interruption())
    time.sleep(2)
    again = os.environ.get("AGAIN") and os.kill(os.getpid(), signal.SIGTERM)
"""


@pytest.mark.parametrize("again", ["", "1"])
def test_a_search_may_answer_a_signal_whose_exception_python_has_dropped(again):
    """The thread beside takes it for noticed, and a later one for a first one."""
    program = DROPPED.replace(
        "import os,", "from planner.support import stopping\nimport os,"
    )
    words = [sys.executable, "-c", program.replace("    time.sleep(10)\n", ANSWERED)]
    own = {**os.environ, "AGAIN": again}
    done = subprocess.run(words, capture_output=True, text=True, timeout=9, env=own)
    first, *last = done.stderr.splitlines()
    assert "Ctrl-C ended the search, whose best plan is taken" in first
    assert (done.returncode, last[-1:]) == (
        (1, ["sim.interruption.Terminated"]) if again else (0, [])
    )


def test_processes_that_are_started_leave_signals_to_this_one():
    program = "import signal; print(len(signal.pthread_sigmask(signal.SIG_BLOCK, ())))"
    with interruption.deaf():
        done = subprocess.run([sys.executable, "-c", program], capture_output=True)
    assert int(done.stdout) == len(ENDS)
    assert signal.pthread_sigmask(signal.SIG_BLOCK, ()) == set()


def test_ctrl_c_ends_the_search_of_a_solver_that_swallows_it(listening, capfd):
    ca = pytest.importorskip("casadi")
    from planner.optimisation.solver import Ipopt

    x = ca.SX.sym("x", 10_000)  # a second of work
    cost = ca.sumsqr(ca.sin(x[1:]) * x[:-1] - 1) + ca.sumsqr(ca.cos(3 * x))
    solve = Ipopt({"x": x, "f": cost, "g": x[2:] * x[:-2]})
    arrives = threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGINT))
    arrives.start()
    with pytest.raises(KeyboardInterrupt):
        solve(x0=1.3, lbg=-2, ubg=2)
    assert capfd.readouterr().err == ""


def test_files_being_written_are_removed_before_an_end_at_once(tmp_path):
    with whole_file(tmp_path / "a.txt") as part:
        part.write_text("half")
        interruption.support.remove_unfinished()
        assert not part.exists()
        part.write_text("whole")
    assert [path.name for path in tmp_path.iterdir()] == ["a.txt"]


@pytest.mark.parametrize("before", [signal.SIG_DFL, lambda *_: None])
def test_whoever_counted_time_before_is_back_when_a_block_ends(before):
    kept = signal.signal(signal.SIGPROF, before)
    try:
        with interruption.processor_time(100.0, TimeoutError()):
            assert signal.getsignal(signal.SIGPROF) is not before
        assert signal.getsignal(signal.SIGPROF) == before
        assert signal.getitimer(signal.ITIMER_PROF) == (0.0, 0.0)
    finally:
        signal.signal(signal.SIGPROF, kept)


def test_a_signal_that_comes_while_an_error_is_told_is_told_as_well(
    monkeypatch, capsys
):
    """As a terminal that is gone ends the input first, and hangs up then."""
    told = iter([lambda _: signal.raise_signal(signal.SIGHUP), cli.last_words])
    monkeypatch.setattr(cli, "last_words", lambda error: next(told)(error))
    assert cli.main(["gallop"]) == 129
    (line,) = capsys.readouterr().err.splitlines()
    assert "SIGHUP" in line
