"""Models from strangers: what they may open, how large they may be, what they say."""

import os
import re
import resource
import subprocess
import sys

import pytest

from models.description import inspection
from models.description.inspection import inspect_model
from models.description.robot import FOLDER
from models.errors import ModelError
from models.library import load

HEXAPOD, CARD, SCENE = (
    (FOLDER / name).read_text() for name in ("hexapod.xml", "hexapod.toml", "scene.xml")
)
BEGIN = HEXAPOD.index(">") + 1  # behind <mujoco ...>
LIMIT = 10  # seconds of the processor in which a bomb is refused
WORLD = '<worldbody><geom size="1"/></worldbody>'


def spent():
    """Seconds that the processor has worked for this process and its children."""
    of = map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(usage.ru_utime + usage.ru_stime for usage in of)


@pytest.fixture
def robot(tmp_path):
    """Write the shipped hexapod with something more in its MJCF; its path."""
    own = tmp_path / "own"
    own.mkdir()

    def write(more=""):
        text = re.sub("<mujoco[^>]*>", lambda head: head[0] + more, HEXAPOD, count=1)
        (own / "mine.xml").write_text(text)
        (own / "mine.toml").write_text(CARD)
        (own / "scene.xml").write_text(SCENE)
        return own / "mine.xml"

    return write


def mesh(path):
    """A pyramid as an OBJ file."""
    path.write_text(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
    )


ENDLESS = ("noslip_iterations", "iterations")


@pytest.mark.parametrize("solver", ENDLESS)
def test_a_robot_whose_steps_would_not_end_is_refused(robot, solver):
    tolerance = solver.replace("iterations", "tolerance")
    path = robot(f'<option {solver}="2000000000" {tolerance}="0"/>')
    with pytest.raises(ModelError, match=f"^{solver} of <option> is 20*, .*mine.xml"):
        inspect_model(path)


OUTSIDE = {
    "a texture that is not drawn": (
        '<compiler discardvisual="true"/>'
        '<asset><texture type="2d" name="t" file="{secret}"/></asset>'
    ),
    "a mesh by its full path": '<asset><mesh name="m" file="{out}/m.obj"/></asset>',
    "a mesh above": '<asset><mesh name="m" file="../out/m.obj"/></asset>',
    "a folder of meshes": (
        '<compiler meshdir="../out"/><asset><mesh name="m" file="m.obj"/></asset>'
    ),
    "a mesh behind a link": '<asset><mesh name="m" file="link.obj"/></asset>',
    "an include": '<include file="../out/more.xml"/>',
    "an include of another suffix": '<include file="../out/more.txt"/>',
    "an include in an include": '<include file="inner.xml"/>',
    "an include spelt otherwise": '<include file="&#46;./out/more.xml"/>',
    "an attached model": '<asset><model name="a" file="../out/more.xml"/></asset>',
    "a height field": (
        '<asset><hfield name="h" file="../out/h.png" size="1 1 1 1"/></asset>'
    ),
    "a side of a box": (
        '<compiler discardvisual="true"/><asset><texture type="cube" name="t" '
        'fileup="../out/h.png"/></asset>'
    ),
}


@pytest.fixture
def elsewhere(tmp_path):
    """A folder that no model is to read."""
    out = tmp_path / "out"
    out.mkdir()
    mesh(out / "m.obj")
    (out / "secret").write_text("a word that nobody else is to know")
    for name in ("more.xml", "more.txt"):
        (out / name).write_text("<mujoco><worldbody><site/></worldbody></mujoco>")
    import imageio.v3 as iio
    import numpy as np

    iio.imwrite(out / "h.png", np.eye(8, dtype=np.uint8))
    return out


@pytest.mark.parametrize("more", OUTSIDE.values(), ids=OUTSIDE)
def test_a_model_opens_nothing_outside_its_folder_unless_it_may(robot, elsewhere, more):
    path = robot(more.format(out=elsewhere, secret=elsewhere / "secret"))
    (path.parent / "link.obj").symlink_to(elsewhere / "m.obj")
    (path.parent / "inner.xml").write_text(
        '<mujoco><include file="../out/more.xml"/></mujoco>'
    )
    with pytest.raises(ModelError, match="opens files outside its own folder: .*mine"):
        load(str(path))
    (taken,) = set(load(str(path), allow_external=True).opened.external)
    assert taken.resolve().is_relative_to(elsewhere)


def test_a_card_behind_a_link_is_outside_too(robot, elsewhere):
    path = robot()
    path.with_suffix(".toml").rename(elsewhere / "card.toml")
    path.with_suffix(".toml").symlink_to(elsewhere / "card.toml")
    with pytest.raises(ModelError, match="outside its own folder: .*mine.toml"):
        load(str(path))
    assert load(str(path), allow_external=True).legs == (1, 2, 3, 4, 5, 6)


def test_a_folder_behind_a_link_is_the_models_own(robot, tmp_path, alone):
    path = robot('<asset><mesh name="m" file="m.obj"/></asset>')
    mesh(path.parent / "m.obj")
    (tmp_path / "link").symlink_to(path.parent)
    assert load(str(tmp_path / "link" / path.name)).opened.external == ()


GEOM = '<geom size="1" pos="0 0 9"/></replicate>'
MANY = f'<worldbody><replicate count="300000">{GEOM}</worldbody>'
BOMBS = {
    "many copies": MANY,
    "a count in disguise": (
        f'<worldbody><replicate sep=">" count="&#51;00000">{GEOM}</worldbody>'
    ),
    "copies of copies": (
        '<worldbody><replicate count="+600"><!-- </replicate> -->'
        f'<replicate count="600">{GEOM}</replicate></worldbody>'
    ),
    "copies elsewhere": '<include file="many.txt"/>',
    "a height field": (
        '<asset><hfield name="h" nrow="40000" ncol="40000" size="1 1 1 1"/></asset>'
    ),
    "a texture": (
        '<asset><texture name="t" type="2d" builtin="checker" width="90000" '
        'height="90000"/></asset>'
    ),
    "a flexible block": (
        '<worldbody><flexcomp name="f" type="grid" count="500 500 500" '
        'spacing=".1 .1 .1" dim="3" mass="1"/></worldbody>'
    ),
    "keyframes": '<size nkey="300000000"/>',
}


@pytest.mark.full
@pytest.mark.parametrize("more", BOMBS.values(), ids=BOMBS)
def test_a_model_that_grows_without_end_is_refused_in_time(robot, more, alone):
    path = robot(more)
    (path.parent / "many.txt").write_text(f"<mujoco>{MANY}</mujoco>")
    began = spent()
    with pytest.raises(ModelError, match="too large: .*more than 8 s or 2 GB"):
        load(str(path))
    assert spent() - began < LIMIT


def test_memory_is_limited(robot, alone):
    """The compiler itself would take this model, at twice its 1.3 GB."""
    field = '<hfield name="h" nrow="18000" ncol="18000" size="1 1 1 1"/>'
    with pytest.raises(ModelError, match="too large: .*more than 8 s or 2 GB"):
        inspect_model(robot(f"<asset>{field}</asset>"))


def test_limits_of_the_session_that_are_lower_are_kept(robot):
    """A session may have less than a trial may take, and most models need little."""
    limited = "import resource, sys; from models.description import inspection\n"
    limited += "resource.setrlimit(resource.RLIMIT_AS, (1_500_000_000,) * 2)\n"
    limited += "resource.setrlimit(resource.RLIMIT_CPU, (6, 7))\n"
    limited += "inspection.main(sys.argv[1])\n"
    limited += (
        "print(*map(resource.getrlimit, (resource.RLIMIT_AS, resource.RLIMIT_CPU)))"
    )
    words = [sys.executable, "-c", limited, str(robot(""))]
    done = subprocess.run(words, capture_output=True, text=True)
    assert done.stdout.splitlines()[-1] == f"{(1_500_000_000,) * 2} (7, 7)"


def test_text_in_another_encoding_is_refused_by_its_line(robot, alone):
    path = robot('<!-- é -->\n<custom><text name="a" data="é"/></custom>')
    path.write_bytes(path.read_text().encode("latin-1"))
    before, _, _ = path.read_text("latin-1").partition("<custom>")
    line = before.count("\n") + 1
    with pytest.raises(ModelError, match=f"byte 0xe9 is no text .*, line {line}; "):
        load(str(path))


def test_a_pipe_is_not_waited_for(robot):
    path = robot('<asset><mesh name="m" file="m.obj"/></asset>')
    os.mkfifo(path.parent / "m.obj")
    with pytest.raises(ModelError, match="not a file: .*m.obj"):
        load(str(path))


def test_a_file_that_is_missing_is_named(robot):
    path = robot(
        '<compiler discardvisual="true"/>'
        '<asset><texture type="2d" name="t" file="gone.png"/></asset>'
    )
    with pytest.raises(ModelError, match="a file is missing: .*gone.png, which"):
        load(str(path))


@pytest.mark.parametrize(
    ("more", "gigabytes"),
    [
        ('<sensor><user dim="70000" needstage="pos"/></sensor>', 0.6),
        ('<size nuserdata="1000000"/>', 8.0),
        ('<sensor><clock name="c" nsample="9000000"/></sensor>', 1.4),
        (
            '<actuator><general joint="swing_1" dyntype="user" actdim="90000"/>'
            "</actuator>",
            0.7,
        ),
        (
            '<asset><hfield name="h" nrow="4000" ncol="4000" size="1 1 1 1"/></asset>',
            2.8,
        ),
    ],
    ids=["a sensor", "user data", "what is remembered", "activations", "heights"],
)
def test_a_compiled_model_leaves_room_for_its_states_and_its_pictures(
    robot, alone, more, gigabytes
):
    """Such a model compiles at once; its numbers have 8 bytes in each of the states.

    A picture of it took 2.7 GB.
    """
    said = f"1000 states and a quarter of what is drawn, {gigabytes} GB, and 0.35 GB"
    with pytest.raises(ModelError, match=f"too large: .* {said}"):
        load(str(robot(more)))


def test_numbers_are_looked_at_that_the_compiled_model_does_not_show(robot):
    unused = '<default class="unused"><geom friction="nan"/></default>'
    with pytest.raises(ModelError, match=r"a number is not finite: .*, line \d+;"):
        load(str(robot(f"<default>{unused}</default>")))


def test_parts_that_take_long_to_name_or_to_leave_out_are_refused(
    robot, alone, monkeypatch
):
    """MuJoCo compares a name with all others, and closes up after each that goes."""
    keys = "<keyframe>" + "<key/>" * 1001 + "</keyframe>"
    said = "too many parts: .* more than 1000 keyframes; name parts, or leave some out"
    with pytest.raises(ModelError, match=said):
        load(str(robot(keys)))
    assert "files" in inspection.report(plain := robot(""))
    monkeypatch.setattr(inspection, "NAMING", 0.0)
    assert re.match(said, inspection.report(plain)["wrong"])


def test_deformable_parts_are_refused(robot, alone):
    cloth = """<worldbody><flexcomp name="cloth" type="grid" count="4 4 1" dim="2"
      spacing=".03 .03 .03" pos="0.3 0 1" radius=".002" mass=".05"/></worldbody>"""
    with pytest.raises(ModelError, match="it has deformable parts, 1 in all: "):
        load(str(robot(cloth)))


def test_a_model_that_takes_all_memory_is_large(monkeypatch, tmp_path):
    def examine(path):
        raise MemoryError

    monkeypatch.setattr(inspection, "examine", examine)
    assert inspection.report(tmp_path) == {"large": True}


def test_a_model_is_looked_at_whatever_encoding_python_is_told_to_print_in(
    monkeypatch,
):
    monkeypatch.setenv("PYTHONIOENCODING", "utf-16")
    inspect_model(FOLDER / "hexapod.xml")


@pytest.mark.parametrize("name", ["a\\b", "lat\udce9"])
def test_a_path_that_mujoco_cannot_open_is_refused_by_its_reason(tmp_path, name):
    """It takes a backslash for a slash, and paths in UTF-8 only."""
    (folder := tmp_path / name).mkdir()
    (folder / "m.xml").write_text("<mujoco/>")
    with pytest.raises(ModelError, match="a backslash in its path, which .* in UTF-8"):
        inspect_model(folder / "m.xml")
