"""The first moments of the command: signals, warnings and streams are prepared.

Loading `sim.cli` takes a tenth of a second. Ctrl-C ends the command during this time in
the same way as later.
"""

import atexit
import gc
import os
import signal
import sys
import warnings
from typing import NoReturn

from sim.endings import ENDS, again, begin, heeded


def main() -> int:
    """Run the command in a process of its own; its exit code."""
    begin(sys.argv[1:])
    for number in heeded():
        signal.signal(number, _end_early)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, ENDS)  # they waited for this
    # All is said on any terminal, and nothing where there is none.
    sys.stdin = sys.stdin or open(os.devnull)  # noqa: SIM115
    for name in ("stdout", "stderr"):  # without a buffer, words may be lost in silence
        given = getattr(sys, name)
        file = given.fileno() if given else os.open(os.devnull, os.O_WRONLY)
        how = "w", 1, given and given.encoding, "backslashreplace"
        setattr(sys, name, open(file, *how, closefd=False))  # noqa: SIM115
    gc.set_threshold(50_000)  # objects between searches for garbage: most last
    os.environ["PYTHONSAFEPATH"] = "1"  # no process takes modules of a working folder
    for name in [name for name in os.environ if name.startswith("SYMPY_")]:
        del os.environ[name]  # SymPy evaluates them
    # our matrices are small: threads would spend their time waiting for one another
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    if not sys.warnoptions:
        warnings.simplefilter("ignore")  # libraries' hints to programmers
        os.environ["PYTHONWARNINGS"] = "ignore"  # in processes that are begun, too
    from sim import cli, interruption

    interruption.watch()
    code = cli.main()
    for number in ENDS:  # all is done and said
        signal.signal(number, signal.SIG_IGN)
    if code in dict(ENDS.values()):  # libraries would take a second more to end
        os.dup2(os.open(os.devnull, os.O_WRONLY), 2)  # some complain of being stopped
        atexit._run_exitfuncs()
        os._exit(code)
    return code


def _end_early(number: int, frame: object) -> NoReturn:
    code, what = ENDS[signal.Signals(number)]
    line = f"stratawalk: error: {what}; nothing was begun; start again: {again()}\n"
    os.write(2, line.encode())
    os._exit(code)


if __name__ == "__main__":
    sys.exit(main())
