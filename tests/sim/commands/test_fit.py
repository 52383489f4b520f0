"""What `fit` hands from the servos to the body, and the sources that it refuses."""

import json
from argparse import Namespace
from copy import copy
from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
import pytest

from models import load
from sim.commands import fit as command
from sim.commands.fit import fit
from sim.errors import UsageError
from sim.fitting.estimate import Estimates, Parameter
from sim.logs.log import Log
from sim.scenarios.file import load_scenario
from sim.templates import render


@dataclass(frozen=True)
class Course:
    """As much of a walk as the command looks at."""

    times: np.ndarray
    in_force: bool = False


SETUP = SimpleNamespace(limits=SimpleNamespace(timestep=0.001))


def options(*sources, **changes):
    given = {"sources": [*sources], "out": None, "json": False, "walking": False}
    more = {"set": [], "allow_external": False, "units": "radians"}
    return Namespace(**given | more | changes)


EARLIER = {"slope": [0.0, 0.0], "payload": [0.0] * 4, "friction": 0.6, "source": []}


def body():
    """A friction of 0.7, known to a tenth, and a load of 20 ms for the table's sake."""
    parameters = (
        Parameter(name="friction", unit="", spread=1.0, step=0.1),
        Parameter(name="late", unit="s", spread=1.0, step=0.1),
    )
    value, start = np.array([[0.7, 0.02]]), np.zeros((1, 2))
    information = np.diag([99.0, 1e6])[None]
    found = Estimates(parameters, start, value, information, np.ones(1))
    settings = {"friction": (0.7, 0.1)}
    return SimpleNamespace(found=found, before=0.004, after=0.001, settings=settings)


@pytest.mark.parametrize(
    ("late", "in_force"), [(0.0, False), (0.03, False), (0.03, True)]
)
def test_the_body_is_fitted_to_a_walk_whose_commands_came_late(
    late, in_force, monkeypatch, capsys, hexapod
):
    """By the delay of the servos, where one was found; those of a run are in force."""
    made = SimpleNamespace(name="ideal")
    setup, asked = SimpleNamespace(robot=hexapod, servo=made), []
    angles = np.zeros((9, 1)) if late else None
    log = SimpleNamespace(measured=angles, done=())
    sources = setup, [log], Course(np.array([1.0, 2.0]), in_force)
    servos = SimpleNamespace(
        settings=lambda *_: {"command_delay": (late, 0.001)},
        joints=(), before=np.zeros(0), after=np.zeros(0),
        make=SimpleNamespace(unseen=list),
    )  # fmt: skip
    monkeypatch.setattr(command, "_sources", lambda _: sources)
    monkeypatch.setattr(command.fitting, "fit_joints", lambda *_: servos)
    shown = {"rows": [], "unseen": {}, "before": 0.0, "after": 0.0}
    monkeypatch.setattr(command, "_of_servos", lambda _: shown)

    def fit_poses(walked):
        asked.append(walked.times.tolist())
        return body()

    monkeypatch.setattr(command, "fit_poses", fit_poses)
    fit(options(json=True))
    off = 0.0 if in_force else late
    assert asked == [pytest.approx([1 - off, 2 - off])]
    told = json.loads(capsys.readouterr().out)
    assert told["settings"]["friction"] == {"value": 0.7, "error": 0.1}
    assert told["body"]["held_out"] == {"before": 0.004, "after": 0.001}
    fit(options())
    said = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert ["friction", "0.70", "+-", "0.10"] in said
    assert ["late", "20.00", "+-", "1.00", "ms"] in said
    monkeypatch.setattr(command.fitting, "write_card", lambda *_: None)
    setup.robot = replace(hexapod, card=replace(hexapod.card, fitted=EARLIER))
    fit(options(out="new.toml"))
    told = "payload, slope of an earlier fit: copy to new.toml what holds"
    assert told in capsys.readouterr().err


def refused(*given, **changes):
    with pytest.raises(UsageError) as caught:
        command._sources(options(*given, **changes))
    return caught.value.what, caught.value.where


def run_of(name, made="ideal", **settings):
    """A finished run of a robot, whose scenario has settings that are not as usual."""
    scenario = replace(load_scenario("line"), robot=name, **settings)
    summary = SimpleNamespace(servo={"name": made})
    return SimpleNamespace(scenario=scenario, summary=summary)


def test_a_run_is_of_its_own_robot_and_fits_no_other(monkeypatch, tmp_path):
    monkeypatch.setattr(command, "read_run", lambda _: run_of("quadruped"))
    again = "a run knows its settings", str(tmp_path)
    slow = {"set": ["swing_speed=0.1"]}
    assert refused(str(tmp_path), **slow) == again
    assert refused("quadruped", str(tmp_path), **slow) == again
    for other in "hexapod", "hexapod-radial":
        said = f"it was walked by another robot than {other}", str(tmp_path)
        assert refused(other, str(tmp_path)) == said


def test_a_run_is_of_the_servos_that_its_robot_has(monkeypatch, tmp_path, hexapod):
    """Those of the card may have been replaced since."""
    monkeypatch.setattr(command, "read_run", lambda _: run_of("hexapod", "mg90"))
    said = f"walked with another servo than {hexapod.path}", str(tmp_path)
    assert refused(str(tmp_path)) == refused("hexapod", str(tmp_path)) == said


@pytest.mark.parametrize(
    ("other", "said"),
    [
        ({"payload": (0.1, 0, 0, 0)}, "walked with another payload than "),
        ({"servo": "own"}, "a run knows its settin"),  # called otherwise, and the same
        ({"dead_band_law": "step"}, "walked with another dead_band_law than "),
        ({"command_rate": 50.0}, "walked with another command_rate than "),
        ({"geometry": {"kappa": 0.5}}, "it was walked by another robot than "),
        ({"imperfect": "hobby", "draw": 3}, "walked with another draw than "),
        ({"draw": 3, "timestep": 0.0005, "swing_speed": 0.1}, "a run knows its settin"),
    ],
    ids=str,
)
def test_runs_that_are_fitted_together_are_of_one_robot_and_its_servos(
    monkeypatch, tmp_path, other, said
):
    """In other places and with other motions, which tell more than one alone."""
    first = {"imperfect": "hobby"} if "imperfect" in other else {}
    runs = {tmp_path / "1": run_of("hexapod", **first)}
    runs[tmp_path / "2"] = run_of("hexapod", **other)
    for folder in runs:
        folder.mkdir()
    monkeypatch.setattr(command, "read_run", runs.__getitem__)
    what, where = refused(*map(str, runs), set=["swing_speed=0.1"])
    assert what.startswith(said)
    assert where == str(tmp_path / ("1" if "settin" in said else "2"))


@pytest.mark.parametrize(
    ("servo", "kept"), [("MG996R", True), ("xl-330", False), (None, False)]
)
def test_dead_bands_of_servos_of_another_make_are_not_kept(
    monkeypatch, hexapod, servo, kept
):
    given = {"dead_band": [0.1], "zero_offset": [0.2], "errors": {}}
    given |= {"servo": servo} if servo else {}  # else they are of the card's own make
    robot = replace(hexapod, card=replace(hexapod.card, fitted=given))
    setup = SimpleNamespace(robot=robot, servo=SimpleNamespace(name="mg996r"))
    asked, shown = [], {"rows": [], "unseen": {}, "before": 0.0, "after": 0.0}
    servos = SimpleNamespace(
        settings=lambda joints, earlier: asked.append(earlier) or {},
        joints=(), before=np.zeros(0), after=np.zeros(0),
        make=SimpleNamespace(unseen=list),
    )  # fmt: skip
    log = SimpleNamespace(measured=np.zeros((9, 1)), done=())
    monkeypatch.setattr(command, "_sources", lambda _: (setup, [log], None))
    monkeypatch.setattr(command.fitting, "fit_joints", lambda *_: servos)
    monkeypatch.setattr(command, "_of_servos", lambda _: shown)
    fit(options())
    (found,) = asked
    assert found.keys() == (given.keys() if kept else given.keys() - {"dead_band"})


def test_a_card_that_was_changed_since_is_of_the_same_robot(tmp_path, hexapod):
    """So is a model that was written into a file, whose numbers are rounded."""
    (tmp_path / "new.xml").write_text(hexapod.read().to_xml())
    card = hexapod.card_text.replace("description = ", 'description = "new"\n# ', 1)
    (tmp_path / "new.toml").write_text(card)
    written = load(str(tmp_path / "new.xml"))
    floor = np.flatnonzero(written.model.body_weldid[written.model.geom_bodyid] == 0)
    written.model.geom_size[floor] += 1.0  # which is infinite, however it is drawn
    assert written.model.body_inertia.tolist() != hexapod.model.body_inertia.tolist()
    assert command._is_alike(written, hexapod)


@pytest.mark.parametrize("name", [*command.BUILT, *command.SHAPES])
def test_a_robot_that_is_built_otherwise_is_another(hexapod, name):
    """Its battery may lie elsewhere, or its legs be longer."""
    model = copy(hexapod.model)
    at = model.geom("foot_1").id if name in command.SHAPES else 1
    getattr(model, name)[at] += 1e-3
    changed = SimpleNamespace(card=hexapod.card, model=model)
    assert not command._is_alike(changed, hexapod)


@pytest.mark.parametrize("walking", [None, True, False])
def test_poses_of_a_run_on_a_stand_are_not_fitted(monkeypatch, tmp_path, walking):
    monkeypatch.setattr(command, "read_run", lambda _: run_of("hexapod"))
    log = logged(pose=np.zeros((2, 3)), measured=np.ones((2, 2)))
    monkeypatch.setattr(command, "log_of", lambda _: log)
    monkeypatch.setattr(command.cli, "reader_of", lambda *_: None)
    monkeypatch.setattr(command.fitting, "check_measured", lambda *_: None)
    monkeypatch.setattr(command.fitting, "check_told", lambda *_: None)
    monkeypatch.setattr(command, "prepare", lambda *_, **__: SETUP)
    monkeypatch.setattr(command, "walked_of_run", lambda *_: "walked")
    _, _, walked = command._sources(options(str(tmp_path), walking=walking))
    assert walked == (None if walking is False else "walked")


def test_poses_that_cannot_be_fitted_are_refused_with_their_log(monkeypatch, hexapod):
    log = logged(pose=np.zeros((2, 3)))
    monkeypatch.setattr(command.cli, "reader_of", lambda *_: lambda _: log)
    monkeypatch.setattr(command.fitting, "check_measured", lambda *_: None)
    monkeypatch.setattr(command.fitting, "check_told", lambda *_: None)
    monkeypatch.setattr(command, "scenario_of", lambda *_: None)
    monkeypatch.setattr(command, "prepare", lambda *_, **__: SETUP)

    def walked(setup, first):
        assert (setup, first.joints) == (SETUP, log.joints)
        raise ValueError("time: too short")

    monkeypatch.setattr(command, "walked_of_log", walked)
    said, where = refused("hexapod", "log.csv", walking=None)
    assert "too short" in said
    assert "log.csv" in where
    monkeypatch.setattr(
        command.cli, "reader_of", lambda *_: lambda _: logged(measured=np.ones((2, 2)))
    )
    setup, _, walked = command._sources(options("hexapod", "log.csv"))
    assert (setup, walked) == (SETUP, None)


def logged(*joints, **measured):
    names = joints or ("a", "b")
    return Log(np.array([0.0, 1.0]), names, np.array([[0.1, 0.2]] * 2), **measured)


def test_logs_of_one_fit_are_brought_into_one_order_and_none_is_passed_over(
    monkeypatch, hexapod
):
    """Joints are fitted to all logs; poses to the first, of a robot that walked."""
    angles, pose = np.array([[0.3, 0.4]] * 2), np.zeros((2, 3))
    logs = {
        "joints": logged(measured=angles),
        "turned": logged("b", "a", measured=angles),
        "others": logged("b", "c", measured=angles),
        "poses": logged(pose=pose),
        "both": logged(measured=angles, pose=pose),
    }
    monkeypatch.setattr(command.cli, "reader_of", lambda *_: lambda at: logs[str(at)])
    for place, name in (
        (command.fitting, "check_measured"),
        (command.fitting, "check_told"),
        (command, "scenario_of"),
        (command, "prepare"),
    ):
        monkeypatch.setattr(place, name, lambda *_, **__: SETUP)
    monkeypatch.setattr(command, "walked_of_log", lambda *_: "walked")
    _, found, walked = command._sources(options("hexapod", "joints", "turned"))
    assert [log.joints for log in found] == [("a", "b")] * 2
    assert found[1].measured.tolist() == [[0.4, 0.3]] * 2
    assert found[1].commanded.tolist() == [[0.2, 0.1]] * 2
    assert walked is None
    assert command._sources(options("hexapod", "both"))[2] is None
    assert command._sources(options("hexapod", "both", walking=None))[2] == "walked"
    what, where = refused("hexapod", "joints", "others")
    assert (what, where) == ("other joints than in joints", "others")
    for given in (["joints", "poses"], ["poses"]):
        what, where = refused("hexapod", *given)
        assert what.startswith("no joint was measured, and only poses of a first log")
        assert where == "poses"


def test_a_fit_that_misses_more_than_the_noise_of_its_log_says_so():
    """Noise is told from a smooth motion by what no smooth motion has."""
    time = np.arange(0, 8, 0.01)
    noise = np.random.default_rng(1).normal(0, np.radians(0.05), (len(time), 1))
    log = Log(time, ("a",), noise, measured=np.sin(3 * time)[:, None] + noise)
    found = command._noise([log, log])
    assert found == pytest.approx(np.radians(0.05), rel=0.1)
    assert command._noise([replace(log, measured=0 * noise)]) == 1e-6  # stuck encoders
    told = {"rows": [], "unseen": {}, "before": 1.0, "noise": found}
    for after, misses in ((1.4 * found, False), (1.7 * found + 1e-4, True)):
        told["after"] = after
        text = render("fit.txt", body=None, written=None, servos=told)
        assert ("times the noise of the log" in text) == misses
