"""The command `stratawalk`; errors end it with one line and an exit code."""

import runpy

if __name__ == "__main__":  # begin as the installed command does, before all else loads
    runpy.run_module("sim.start", run_name="__main__")  # which exits

import json
import os
import select
import sys
import traceback
from collections.abc import Sequence
from contextlib import chdir, suppress
from typing import TextIO

from sim import interruption
from sim.commands.parsing import as_meant, parser
from sim.endings import begin
from sim.errors import ExitCode, exit_code, last_words, printable
from sim.pictures import gl


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command line, that of the process if None is given; its exit code."""
    words = list(sys.argv[1:] if arguments is None else arguments)
    begin(words)
    gl.choose()
    with interruption.listening():
        try:
            try:
                code = _execute(words)
                print(end="", flush=True)  # a reader that left must be noticed here
            except BaseException as error:  # a user's own Python may raise anything
                return _fail(interruption.meant(error), words)
        except KeyboardInterrupt as error:  # which came while another was told
            return _fail(interruption.meant(error), words)
        return code


def _execute(words: Sequence[str]) -> int:
    try:
        options = parser().parse_args(as_meant(words))
    except SystemExit as finished:  # --help
        return int(finished.code or ExitCode.OK)
    os.environ["MPLBACKEND"] = "agg"  # all figures are files, whatever others are
    date = os.environ.get("SOURCE_DATE_EPOCH", "0")
    if len(date) > 11 or not date.isdecimal():  # Matplotlib's files must do without it
        del os.environ["SOURCE_DATE_EPOCH"]
    import logging  # slow to import, and of no use to `--help`

    logging.getLogger("matplotlib").setLevel(logging.ERROR)  # no word of its fonts
    os.environ["MATPLOTLIBRC"] = os.devnull  # settings of a person may ask for LaTeX
    if os.path.lexists("matplotlibrc"):  # Matplotlib would obey what lies in a folder
        with chdir(os.sep):
            import matplotlib  # noqa: F401 (it reads that file here alone)
    return int(options.execute(options) or ExitCode.OK)


def _fail(error: BaseException, words: Sequence[str]) -> int:
    """Report an error as the command line asked for; its exit code."""
    code = exit_code(error)
    if isinstance(error, BrokenPipeError) and _reader_left():
        _silence(sys.stdout, sys.stderr)
        return ExitCode.OK
    try:
        if "--debug" in words:
            whole = "".join(traceback.format_exception(error))
            print(printable(whole), end="", file=sys.stderr)
        print(f"stratawalk: error: {last_words(error)}", file=sys.stderr, flush=True)
    except OSError:  # it is on a full disk
        _silence(sys.stderr)
    try:
        if "--json" in words:
            facts = {"exit_code": int(code), "kind": code.name.lower()}
            print(json.dumps({"error": facts | {"message": last_words(error)}}))
        print(end="", flush=True)
    except OSError:
        _silence(sys.stdout, sys.stderr)
    return code


def _reader_left() -> bool:
    """Whether the reader of standard output has closed it, having seen enough."""
    output = select.poll()
    output.register(sys.stdout.fileno(), select.POLLERR)
    return bool(output.poll(0))


def _silence(*streams: TextIO) -> None:
    """Keep Python from failing again when it flushes the streams at exit."""
    for stream in streams:
        with suppress(OSError, ValueError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
