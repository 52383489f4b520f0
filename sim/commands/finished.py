"""What to do with a finished run: show its report, film it, view it, cite it."""

import argparse
import os
import re
import sys
from collections.abc import Iterator
from functools import partial
from importlib.metadata import version
from importlib.resources import files
from pathlib import Path
from urllib.parse import urlsplit

from sim.commands import options as cli
from sim.errors import ExitCode, exit_code
from sim.folder import blamed_on, new_file
from sim.progress import bar
from sim.runs.run import Run, read_run


def show(options: argparse.Namespace) -> None:
    """Draw the report, print its path and open it."""
    from sim.reports.page import write_report

    folder = cli.run_of(options)
    with bar(quiet=options.json) as progress, blamed_on(folder):
        path = write_report(read_run(folder), progress)
    cli.report(options, {"report": str(path)}, path)
    _open(path.as_uri(), options.browser)


def _open(address: str, wanted: bool | None) -> None:
    """Open a page in a browser, by default where its window would be seen."""
    import webbrowser

    screen = os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    if not (sys.platform == "darwin" or screen if wanted is None else wanted):
        return
    sys.stdout.flush()
    if not webbrowser.open(address):
        cli.notice(f"no browser found for {address}", "warning")


def film(options: argparse.Namespace) -> None:
    """Film the run and print the film's path."""
    from sim.pictures.run_film import film_folder

    folder, out = cli.run_of(options), options.out
    path = None if out is None else new_file(Path(out), "film", ".mp4", ".webp")
    if folder != Path(options.run):  # none was named
        cli.notice("the film of a whole walk takes minutes; --to 5 films its first 5 s")
    with bar(quiet=options.json) as progress:
        filmed = film_folder(
            folder,
            look=options.look,
            camera=options.camera,
            stretch=(options.start, options.stop),
            path=path,
            progress=partial(progress, "filming"),
        )
    cli.report(options, {"film": str(filmed)}, filmed)


def view(options: argparse.Namespace) -> None:
    """Serve the viewer until Ctrl-C, or write the replay."""
    if options.replay:
        from sim.viewing.replay import write_replay

        with bar(quiet=options.json) as progress:
            path = write_replay(cli.run_of(options), partial(progress, "replay"))
        cli.report(options, {"replay": str(path)}, path)
        _open(path.resolve().as_uri(), options.browser)
        return
    from sim.viewing.web import require_loopback, serve

    require_loopback(options.host, options.public)

    def started(address: str, once: str) -> None:
        port = urlsplit(address).port
        print(f"{address}\n\nCtrl-C ends it. From another machine, open it after:")
        print(f"  ssh -L {port}:localhost:{port} THIS-MACHINE", flush=True)
        _open(once, options.browser)

    try:
        serve(cli.run_of(options), options.host, options.port, options.speed, started)
    except KeyboardInterrupt as stop:
        if exit_code(stop) is not ExitCode.INTERRUPTED:
            raise
        print(file=sys.stderr)  # the shell's next line begins below ^C


def cite(options: argparse.Namespace) -> None:
    """Print BibTeX entries."""
    keys, made = ["stratawalk", "goodwine2000"], version("stratawalk")
    if options.run is not None:
        folder = Path(options.run)
        with blamed_on(folder):
            run = read_run(folder)
            keys += _used(run)
            release = str(run.summary.versions.get("stratawalk", made))
            made = re.sub(r"[^\w.+-]", "", release)  # which ends no entry
    text = (files("sim.commands") / "references.bib").read_text("utf-8")
    entries = {
        re.findall(r"{(.*?),", part)[0]: f"@{part.strip()}"
        for part in text.removeprefix("@").split("\n@")
    }
    bibtex = "\n".join(entries[k].replace("{VERSION}", f"{{{made}}}") for k in keys)
    cli.report(options, {"keys": keys, "bibtex": bibtex}, bibtex)


def _used(run: Run) -> Iterator[str]:
    """Keys of what a run was planned, predicted and simulated with."""
    optimised = run.summary.optimise != "none"
    yield from ("andersson2019", "waechter2006") if optimised else ("lafferriere1991",)
    yield "todorov2012"
    if run.summary.predicted.get("quasi_static"):
        yield from ("murphey2006", "hatton2025")
    if run.summary.predicted.get("compliant"):
        yield "alart1991"
    if run.scenario.obstacles:
        yield "sucan2012"
