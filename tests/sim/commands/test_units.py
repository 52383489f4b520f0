"""How commands read logs in counts, judge tables of designs, and own cards."""

import shutil
from argparse import Namespace
from types import SimpleNamespace

import numpy as np
import pytest

from models import load
from models.description import FOLDER
from sim import load_scenario
from sim.commands import calibrate, export, options as cli, studies, walks
from sim.commands.declared import Command
from sim.errors import UsageError
from sim.export import servo_table as tables, source as sources
from sim.studies.designing import DIRECTIONS
from sim.world import servos


@pytest.mark.parametrize(
    ("units", "signal", "pulses"),
    [
        ("counts", "pulse", True), ("counts", "bus", False), ("counts", None, None),
        ("microseconds", "bus", True), ("microseconds", None, True),
    ],
)  # fmt: skip
def test_counts_are_those_of_pulses_where_the_make_takes_them(
    units, signal, pulses, monkeypatch, hexapod
):
    make, asked = signal and SimpleNamespace(signal=signal), []
    settings = SimpleNamespace(kind=make, rate=60.0)
    monkeypatch.setattr(servos, "servo_settings", lambda *_: settings)

    def servo_table(card, joints, make, pwm, rate):
        asked.append(pwm)
        channels = SimpleNamespace(channels=[])
        return SimpleNamespace(channels=[], in_microseconds=lambda: channels)

    monkeypatch.setattr(tables, "servo_table", servo_table)
    cli.reader_of(Namespace(units=units), hexapod, None)
    assert asked == [pulses]


def test_counts_of_servos_of_no_make_are_those_of_the_card(tmp_path):
    """Which `calibrate` has written, with the divider of a board."""
    for name in ("hexapod.xml", "scene.xml"):
        shutil.copy(FOLDER / name, tmp_path)
    card = (FOLDER / "hexapod.toml").read_text() + "\n[board]\ndivider = 122\n"
    joints = load("hexapod").card.joints
    table = "\n[servo.{}]\ncenter = 307\ncounts_per_radian = 131\n"
    (tmp_path / "hexapod.toml").write_text(card + "".join(map(table.format, joints)))
    (log := tmp_path / "log.csv").write_text(
        f"time,{','.join(joints)}\n" + "".join(f"{t}{',320' * 12}\n" for t in (0, 1))
    )
    robot = load(str(tmp_path / "hexapod.xml"))
    scenario = load_scenario("line", {"robot": str(tmp_path / "hexapod.xml")})
    read = cli.reader_of(Namespace(units="counts"), robot, scenario)(log)
    assert read.commanded == pytest.approx(np.full((2, 12), 13 / 131))


def test_the_best_design_is_the_one_of_fewest_strokes():
    rows = [
        {"joints": 12, "min_margin": margin, "strokes_per_metre": strokes}
        | {f"goes.{way}": way != lacks for way in DIRECTIONS}
        for margin, strokes, lacks in (
            (0.01, 30.0, None), (0.02, 20.0, None), (0.05, 25.0, DIRECTIONS[0]),
            (None, 1.0, None),
        )
    ]  # fmt: skip
    ((joints, count, goes, able, walked, best),) = studies._by_joints(rows)
    assert (joints, count, able, walked) == (12, 4, 3, 3)
    assert goes.tolist() == [3, *[4] * (len(DIRECTIONS) - 1)]
    assert best is rows[1]


@pytest.mark.parametrize(
    ("inside", "check"), [(True, False), (True, True), (False, False)]
)
def test_a_card_inside_a_robot_s_file_is_only_checked(inside, check, tmp_path):
    robot = SimpleNamespace(path=tmp_path / "own.xml", has_card_inside=inside)
    given = robot, None, Namespace(check=check)
    if inside and not check:
        with pytest.raises(UsageError, match="the card is inside the robot's file"):
            calibrate._owned(*given)
    else:
        assert calibrate._owned(*given) is robot


@pytest.mark.parametrize(
    ("extra", "missing", "refused"),
    [("sweep", "dask", True), ("sweep", "planner", False), ("", "dask", False)],
)
def test_a_package_of_an_extra_is_asked_for_and_no_part_of_ours(
    extra, missing, refused, monkeypatch
):
    def import_module(name):
        raise ModuleNotFoundError(f"No module named {missing!r}", name=missing)

    monkeypatch.setattr("sim.commands.declared.import_module", import_module)
    with pytest.raises(UsageError if refused else ModuleNotFoundError) as caught:
        Command("sweep", "sweeps", extra)(None)
    if refused:
        assert caught.value.what == "package 'dask' is not installed"
        assert caught.value.where == "the extra 'sweep'"


@pytest.mark.parametrize(("kind", "coarse"), [("header", 1 / 300), ("ros2", 0.0)])
def test_what_is_read_back_may_differ_by_a_count_of_the_finest_servo(
    kind, coarse, monkeypatch
):
    channels = [SimpleNamespace(counts_per_radian=n) for n in (120.0, 300.0, 200.0)]
    table = SimpleNamespace(channels=channels, assumed=False)
    monkeypatch.setattr(sources, "servos", lambda *_, **__: table)
    monkeypatch.setattr(sources, "write", lambda *_: None)
    monkeypatch.setattr(sources, "read", lambda *_: "read")
    servo = SimpleNamespace(kind=None)
    source = SimpleNamespace(commands=lambda rate: ("commands", rate), servo=servo)
    options = Namespace(servo_table=None, rate=50.0, format=kind, microseconds=False)
    found = export._written(options, source, None)
    assert found == (("commands", 50.0), "read", pytest.approx(coarse))


def test_logs_that_do_not_fit_together_are_refused_with_the_first(monkeypatch, capsys):
    def together(logs):
        raise ValueError("other joints")

    monkeypatch.setattr(walks, "together", together)
    monkeypatch.setattr(cli, "robot_of", lambda *_: None)
    log = SimpleNamespace(pose=np.array([[0, 0, np.nan], [0, 0, 90.0]]))
    monkeypatch.setattr(cli, "reader_of", lambda *_: lambda _: log)
    monkeypatch.setattr("sim.logs.playing.scenario_of", lambda *_: None)
    given = {"robot": "hexapod", "set": [], "repeat": 1, "video": False}
    with pytest.raises(UsageError) as caught:
        walks.play(Namespace(files=["only.csv"], **given))
    assert "only.csv" in str(caught.value)
    assert "other joints" in str(caught.value)
    assert "body.yaw is in radians: 90 degrees is 1.5708" in capsys.readouterr().err
