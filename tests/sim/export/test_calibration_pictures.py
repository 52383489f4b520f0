"""Pictures and the printed sheet by which servos are found."""

import errno
import io
import os
import re
from contextlib import nullcontext
from types import SimpleNamespace

import numpy as np
import pytest
from PIL import Image

from models import Kinematics, load
from sim.cli import main
from sim.commands.calibrate import _write
from sim.errors import FilesError, RenderError, UsageError
from sim.export import calibration
from sim.folder import RunFolder
from tests.commands import full_disk
from tests.hostile import named_otherwise

ROBOT = "hexapod-classroom"


class Camera:
    """Draws nothing but black, without a driver."""

    def __init__(self, look=lambda data, view: None):
        self.update_scene = look

    def render(self):
        """Two pixels by two."""
        return np.zeros((2, 2, 3), dtype=np.uint8)


def test_a_joint_is_drawn_from_its_own_side_of_the_robot(tmp_path, monkeypatch):
    """The camera alone, without a driver: its azimuth is the way that it looks."""
    robot, seen = load(ROBOT), []

    def look(data, view):
        way = np.radians(view.azimuth)
        stands = -np.array([np.cos(way), np.sin(way)])
        seen.append((stands, view.lookat.copy(), data.qpos[:3].copy()))

    monkeypatch.setattr("mujoco.Renderer", lambda *_, **__: nullcontext(Camera(look)))
    calibration._draw(robot, tmp_path)
    kinematics = Kinematics(robot)
    hips = [kinematics.hinge(joint)[1][:2] for joint in robot.card.joints]
    assert len(seen) == 2 * len(hips)
    for (stands, middle, torso), hip in zip(
        seen, np.repeat(hips, 2, axis=0), strict=True
    ):
        assert (middle == torso).all()
        assert stands @ hip > 0.7 * np.linalg.norm(hip)  # within 45 degrees


def test_a_disk_that_is_full_leaves_no_half_of_a_picture(tmp_path, monkeypatch):
    monkeypatch.setattr("mujoco.Renderer", lambda *_, **__: nullcontext(Camera()))
    save, saved = Image.Image.save, []

    def full(image, path):
        saved.append(path)
        if len(saved) == 2:
            path.touch()
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        save(image, path)

    monkeypatch.setattr(Image.Image, "save", full)
    with pytest.raises(FilesError, match="disk full: .*joint-2.png; free some space"):
        calibration._draw(load(ROBOT), tmp_path)
    (drawn,) = tmp_path.iterdir()
    assert drawn.name == "joint-1.png"
    with Image.open(drawn) as picture:
        assert picture.size == (4, 2)


def test_joints_that_could_not_be_drawn_are_drawn_when_the_work_goes_on(
    tmp_path, monkeypatch, capsys
):
    robot, tries = load(ROBOT), []

    def draw(robot, folder, *, allow_external):
        tries.append(folder)
        if len(tries) == 1:
            raise RenderError("cannot draw the joints", "disk full", "free some space")
        (folder / f"joint-{len(robot.card.joints)}.png").touch()

    monkeypatch.setattr("sim.export.calibration.draw", draw)
    (tmp_path / "answers").write_text("")
    words = ["calibrate", robot.name, "--answers", str(tmp_path / "answers")]
    for _ in range(3):
        assert main([*words, "--out", str(tmp_path / "a")]) == 2
        assert (tmp_path / "a" / "index.html").exists()
    assert len(tries) == 2
    assert capsys.readouterr().err.count("warning: cannot draw the joints") == 1


@pytest.mark.full
@pytest.mark.render
@pytest.mark.usefixtures("driver")
def test_each_joint_is_drawn_at_both_marks_in_colour(tmp_path):
    named = named_otherwise(tmp_path, "../../evil")  # no picture beside the folder
    fine = '<visual><quality numslices="20000" numstacks="20000"/></visual>'
    named.write_text(named.read_text().replace("<worldbody>", f"{fine}<worldbody>", 1))
    robot, folder = load(str(named)), tmp_path / "a" / "b"
    folder.mkdir(parents=True)
    before = set(tmp_path.rglob("*"))
    calibration.draw(robot, folder, allow_external=False)
    made = {folder / f"joint-{n}.png" for n in range(1, 1 + len(robot.card.joints))}
    assert set(tmp_path.rglob("*")) - before == made
    for file in made:
        picture = np.asarray(Image.open(file)).astype(int)
        red = picture[..., 0] > picture[..., 1:].max(axis=-1) + 60
        left, right = np.split(red, 2, axis=1)
        assert left.any()
        assert right.any()
        assert (left != right).any()  # the joint has moved
        assert red.mean() < 0.05  # and nothing else is red


def test_the_sheet_has_its_size_and_a_ring_of_a_degree_for_each_foot():
    robot = load(ROBOT)
    text = calibration.sheet(robot)
    millimetres = re.findall(r'(?:width|height)="([\d.]+)mm"', text)
    feet = Kinematics(robot).standing.feet
    edge = 4 * 0.02  # two on every side
    size = np.array(millimetres, dtype=float) / 1e3
    assert size == pytest.approx(np.ptp(feet, axis=0) + edge, abs=1e-6)  # as written
    number = r"(-?[\d.]+)"
    line = f'class="leg" d="M {number} {number} L {number} {number}"'
    legs = np.array(re.findall(line, text), dtype=float)  # from hip to foot [mm]
    lengths = np.hypot(*(legs[:, 2:] - legs[:, :2]).T)
    hips = [Kinematics(robot).hinge(leg.swing)[1][:2] for leg in robot.leg_cards]
    assert lengths == pytest.approx(1e3 * np.hypot(*(feet - hips).T), abs=2e-3)
    arcs = re.findall(f"a {number} {number} 0 1 0 {number} 0 a", text)
    radii = np.radians(1) * lengths
    assert np.array(arcs, dtype=float) == pytest.approx(
        np.stack([radii, radii, 2 * radii], axis=1), abs=2e-3
    )
    assert (np.sort(size) < [0.297, 0.420]).all()  # A3, as docs/first-robot.md says


def test_the_name_of_a_folder_commands_no_terminal(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "answers").write_text("")
    name = "a\x1b[2J"
    (tmp_path / name).mkdir()
    (tmp_path / name / f"joint-{len(load(ROBOT).card.joints)}.png").touch()
    words = ["calibrate", "hexapod-classroom", "--out", name, "--answers", "answers"]
    assert main(words) == 2
    told = capsys.readouterr()
    assert "\x1b" not in told.out + told.err
    assert "a\\x1b[2J" in told.out


def test_a_pipe_that_does_not_answer_a_question_is_left_at_once(
    tmp_path, monkeypatch, capsys
):
    pipe = io.StringIO("y\n" * 1000)
    monkeypatch.setattr("sys.stdin", pipe)
    monkeypatch.setattr("sim.export.calibration.draw", lambda *_, **__: None)
    assert main(["calibrate", ROBOT, "--out", str(tmp_path / "a")]) == 2
    said = capsys.readouterr().err
    assert "an answer that cannot be used, " in said
    assert pipe.tell() == len("y\n")
    kept, left_out = "keeps 0 of 12 servos; ", "leave out the answers that it has; "
    assert f"{kept}{left_out}go on: stratawalk calibrate" in said


@pytest.mark.parametrize(
    ("errors", "said"), [("warning\nno display\n", "no display"), ("", "no picture")]
)
def test_joints_that_cannot_be_drawn_are_told_with_the_last_word_of_why(
    tmp_path, monkeypatch, errors, said
):
    called, robot = [], load(ROBOT)

    def child(probe, limit, *words, module):
        called.append((words, module))
        return SimpleNamespace(returncode=1, stderr=errors)

    monkeypatch.setattr(calibration.gl, "probe", lambda: "egl")
    monkeypatch.setattr(calibration.gl, "child", child)
    for external in (False, True):
        with pytest.raises(RenderError) as caught:
            calibration.draw(robot, tmp_path, allow_external=external)
        assert caught.value.what == "cannot draw the joints"
        assert caught.value.where == said
    own = str(robot.path), str(tmp_path)
    module = "sim.export.calibration"
    assert called == [(own, module), ((*own, "external"), module)]


@pytest.mark.parametrize("name", ["index.html", "feet.svg", f"{ROBOT}.toml"])
def test_a_folder_of_somebody_else_is_refused(name, tmp_path, capsys):
    (tmp_path / name).write_text("mine")
    assert main(["calibrate", ROBOT, "--out", str(tmp_path)]) == 2
    assert f"{name}; give --out another name" in capsys.readouterr().err
    assert (tmp_path / name).read_text() == "mine"
    assert [path.name for path in tmp_path.iterdir()] == [name]


def test_a_sketch_that_its_owner_has_changed_stays_and_that_is_told(
    tmp_path, monkeypatch, capsys
):
    words = ("calibrate", ROBOT, "--out", str(tmp_path / "mine"))
    monkeypatch.setattr("sim.export.calibration.draw", lambda *_, **__: None)
    monkeypatch.setattr("sys.stdin", io.StringIO())
    assert main(words) == 2
    sketch = tmp_path / "mine" / "jog.ino"
    assert main(words) == 2
    assert "stays; remove it" not in capsys.readouterr().err
    sketch.write_text("// my pins\n" + sketch.read_text())
    assert main(words) == 2
    assert sketch.read_text().startswith("// my pins\n")
    assert f"{sketch} stays; remove it" in capsys.readouterr().err
    sketch.unlink()
    assert main(words) == 2
    assert "answers end" in capsys.readouterr().err
    assert sketch.read_text().startswith("/")


def test_a_page_of_another_robot_is_not_taken_for_this_one_s(
    tmp_path, monkeypatch, capsys
):
    monkeypatch.setattr("sim.export.calibration.draw", lambda *_, **__: None)
    monkeypatch.setattr("sys.stdin", io.StringIO())
    for robot, said in (
        (ROBOT, "answers end"),
        ("quadruped", "index.html; give --out"),
    ):
        assert main(["calibrate", robot, "--out", str(tmp_path / "mine")]) == 2
        assert said in capsys.readouterr().err
    page = (tmp_path / "mine" / "index.html").read_text()
    assert f"Calibration of {ROBOT}" in page


def test_strokes_to_check_replace_those_of_before_and_no_other_file(tmp_path):
    folder = RunFolder(tmp_path)
    for counts in ("1", "2"):  # of a card that was corrected
        _write(folder, "check.h", f"// strokes\n{counts}\n", known=1)
        assert counts in (tmp_path / "check.h").read_text()
    with pytest.raises(UsageError, match="already exists: .*check.h; give --out"):
        _write(folder, "check.h", "// others\n", known=1)
    assert (tmp_path / "check.h").read_text() == "// strokes\n2\n"


def test_a_picture_that_is_there_is_not_drawn_again(tmp_path, monkeypatch):
    monkeypatch.setattr("mujoco.Renderer", lambda *_, **__: nullcontext(Camera()))
    (tmp_path / "joint-2.png").write_text("mine")
    calibration._draw(load(ROBOT), tmp_path)
    assert len([*tmp_path.iterdir()]) == 12
    assert (tmp_path / "joint-2.png").read_text() == "mine"


def test_a_picture_that_is_interrupted_leaves_nothing(tmp_path, monkeypatch):
    def killed(driver, limit, robot, folder, **module):
        (tmp_path / "joint-1.png").touch()
        (tmp_path / ".joint-2.0123456789abcdef.part.png").touch()
        raise KeyboardInterrupt

    monkeypatch.setattr(calibration.gl, "probe", lambda: "egl")
    monkeypatch.setattr(calibration.gl, "child", killed)
    with pytest.raises(KeyboardInterrupt):
        calibration.draw(load(ROBOT), tmp_path, allow_external=False)
    assert [path.name for path in tmp_path.iterdir()] == ["joint-1.png"]


def test_a_card_whose_robot_finds_no_room_is_not_left_alone(tmp_path, monkeypatch):
    """Or the command that is told to go on is refused because of it."""
    monkeypatch.setattr("mujoco.MjSpec.to_xml", full_disk)
    assert main(["calibrate", ROBOT, "--out", str(tmp_path / "mine")]) == 6
    assert not [*tmp_path.rglob("*.toml")]
