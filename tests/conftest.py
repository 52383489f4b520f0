"""Shared parts: a world built from the shipped hexapod, and a short real walk."""

import gc
import os
import shutil
import signal
import subprocess
import sys

import pytest
from filelock import FileLock

from models.description import inspection
from models.description.robot import FOLDER
from models.library import load as load_robot
from sim import run_folder
from sim.errors import RenderError
from sim.folder import RunFolder
from sim.pictures.run_film import check
from sim.reports.page import NAME
from sim.run_folder import run
from sim.scenarios.body_path import line
from sim.scenarios.scenario import Scenario
from tests import shipped
from tests.trials import FORKED
from tests.walks import COSTLY

REPORT = run_folder._report
shipped.share()
# Tests begin many processes, each of which would otherwise compile all modules anew.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False
# A job in the background ignores these, and so would all that a test starts.
ANSWERS = {signal.SIGINT: signal.default_int_handler, signal.SIGHUP: lambda *_: None}
for _number, _answer in ANSWERS.items():
    if signal.getsignal(_number) is signal.SIG_IGN:
        signal.signal(_number, _answer)


def pytest_collection_finish():
    """What lives as long as the tests do is not looked through for garbage."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(20_000, 20)


def pytest_collection_modifyitems(items):
    """Whole walks take as long as they need; only quick tests have a limit.

    Last are small tests without fixtures, for the worker that is idle to take over.
    """
    items.sort(key=lambda item: item.nodeid.startswith("tests/planner/"))
    for item in items:
        if item.get_closest_marker("full"):
            item.add_marker(pytest.mark.timeout(0))


@pytest.fixture(autouse=True)
def trials(monkeypatch):
    """Robots of strangers are tried without the start of a process each."""
    monkeypatch.setattr(inspection, "subprocess", FORKED)


@pytest.fixture
def alone(trials, monkeypatch):
    """Models are tried in processes of their own, as everywhere but in tests."""
    monkeypatch.setattr(inspection, "subprocess", subprocess)


@pytest.fixture(autouse=True, scope="session")
def pageless():
    """Run folders have no page, which is drawn for longer than most tests walk."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(run_folder, "_report", lambda *_: None)
        yield


@pytest.fixture
def paged(monkeypatch):
    """Run folders have their page, as everywhere but in tests."""
    monkeypatch.setattr(run_folder, "_report", REPORT)


@pytest.fixture
def quick(monkeypatch):
    """Runs leave out predictions that cost physics of their own."""
    monkeypatch.setitem(run.__kwdefaults__, "without", COSTLY)


@pytest.fixture(scope="session")
def hexapod():
    return load_robot("hexapod")


@pytest.fixture
def edited(tmp_path):
    """Make the shipped hexapod with some of its text replaced; gives the robot."""

    def make(*edits):
        names = ("hexapod.xml", "hexapod.toml", "scene.xml")
        texts = [(FOLDER / name).read_text() for name in names]
        for old, new in zip(edits[::2], edits[1::2], strict=True):
            assert any(old in text for text in texts), old
            texts = [text.replace(old, new) for text in texts]
        for name, text in zip(names, texts, strict=True):
            (tmp_path / name).write_text(text)
        return load_robot(str(tmp_path / "hexapod.xml"))

    return make


@pytest.fixture
def scenario():
    """Make a scenario that differs from a short straight line only in what is given."""

    def make(**changes):
        given = {
            "name": "short",
            "segments": 2,
            "path": line((0.01, 0.01, 0.0)),
        } | changes
        return Scenario(**given)

    return make


@pytest.fixture(scope="session")
def driver():
    try:
        return check()
    except RenderError as error:
        pytest.skip(f"no films on this machine: {error}")


@pytest.fixture(scope="session")
def walked(tmp_path_factory, worker_id):
    """Run folder of 3 cm straight ahead, 15 s played in a quarter of one.

    It is walked once, and copied by each of the processes that share the tests.
    """
    own = tmp_path_factory.getbasetemp()
    made = (own if worker_id == "master" else own.parent) / "made"
    with FileLock(made.with_suffix(".lock")):
        if not (made / NAME).exists():
            shutil.rmtree(made, ignore_errors=True)
            made.mkdir()
            short = {"segments": 2, "path": line((0.03, 0.0, 0.0)), "playback": 60.0}
            with pytest.MonkeyPatch.context() as patched:
                patched.setattr(run_folder, "_report", REPORT)
                run(Scenario(name="short", **short), RunFolder(made))
    return shutil.copytree(made, own / "walked")


@pytest.fixture
def folder(walked, tmp_path):
    """A copy of the run folder, to be spoilt."""
    return shutil.copytree(walked, tmp_path / "it's a: run")
