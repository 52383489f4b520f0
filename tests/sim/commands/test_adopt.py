"""`stratawalk adopt`: writes a card and a picture beside a file, and nothing else."""

import json
import re
import signal
from argparse import Namespace
from os import times
from time import process_time
from types import SimpleNamespace

import pytest

from models.errors import ModelError
from models.library import load
from planner.support import remove_unfinished
from scripts.adoptees import ADOPTEES, Adoptee, radial
from sim.cli import main
from sim.commands import robots

SPIDER, BOX = ADOPTEES[0], ADOPTEES[-1]
FOUR = Adoptee("four", radial(4), drive="motor")


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def test_card_and_picture_are_written_and_the_file_is_left_alone(tmp_path, capsys):
    path = SPIDER.write(tmp_path)
    before = path.read_bytes()
    assert main(["adopt", str(path)]) == 0
    out = capsys.readouterr().out
    assert "guessed     the file puts the feet at different heights" in out
    assert "legs 1 4 5: turned by up to" in out
    assert "correct it, and walk: stratawalk run line" in out
    assert path.read_bytes() == before
    assert names(tmp_path) == ["spider.png", "spider.toml", "spider.xml"]
    assert load(str(path)).card.groups.keys() == {"1", "2"}


def test_what_a_robot_lacks_for_walking_is_said_before_a_walk_is_advised(
    tmp_path, capsys, monkeypatch
):
    looked = robots.inspected
    lacking = {"lacks": ["it cannot go sideways"]}
    monkeypatch.setattr(robots, "inspected", lambda *of: looked(*of) | lacking)
    assert main(["adopt", str(SPIDER.write(tmp_path))]) == 0
    out = capsys.readouterr().out
    assert "lacks       it cannot go sideways" in out
    assert "correct it, mend what the robot lacks, and walk: stratawalk run " in out


def test_urdf_is_given_an_mjcf(tmp_path, capsys):
    path = BOX.write(tmp_path)
    assert main(["adopt", str(path), "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert names(tmp_path) == ["box.png", "box.toml", "box.urdf", "box.xml"]
    assert len(report["robot"]["legs"]) == 6


def test_a_model_folder_with_a_scene_is_adopted_by_its_name(tmp_path, capsys):
    SPIDER.write(tmp_path)
    (tmp_path / "scene.xml").write_text(
        '<mujoco><include file="spider.xml"/><worldbody><geom name="floor" '
        'type="plane" size="0 0 0.05"/></worldbody></mujoco>'
    )
    assert main(["adopt", str(tmp_path)]) == 0
    assert f"--robot {tmp_path / 'spider.xml'}\n" in capsys.readouterr().out
    assert (tmp_path / "spider.toml").is_file()


@pytest.mark.parametrize("name", ["spider.toml", "spider.png"])
def test_nothing_is_written_over(tmp_path, capsys, name):
    path = SPIDER.write(tmp_path)
    (tmp_path / name).write_text("mine")
    assert main(["adopt", str(path)]) == 2
    assert "already exists" in capsys.readouterr().err
    assert names(tmp_path) == sorted([name, "spider.xml"])
    assert (tmp_path / name).read_text() == "mine"


def test_of_two_that_adopt_a_robot_at_once_the_second_is_refused(
    tmp_path, capsys, monkeypatch
):
    path, draft_card = SPIDER.write(tmp_path), robots.models.draft_card

    def slowly(source):
        found = draft_card(source)
        (tmp_path / "spider.toml").write_text("of the first")
        return found

    monkeypatch.setattr(robots.models, "draft_card", slowly)
    assert main(["adopt", str(path)]) == 2
    assert "spider.toml; give another name, or move it away" in capsys.readouterr().err
    assert (tmp_path / "spider.toml").read_text() == "of the first"
    assert names(tmp_path) == ["spider.toml", "spider.xml"]


@pytest.mark.parametrize("late", ["box.xml", "box.png"])
def test_files_of_others_that_appear_meanwhile_are_kept(late, tmp_path, monkeypatch):
    """A model file once the legs are found, a picture while the robot stands."""
    path = BOX.write(tmp_path)
    own, name = {
        "box.xml": (robots.models, "draft_card"),
        "box.png": (robots, "prepare"),
    }[late]
    function = getattr(own, name)

    def found(*words, **more):
        (tmp_path / late).write_text("precious")
        return function(*words, **more)

    monkeypatch.setattr(own, name, found)
    assert main(["adopt", str(path)]) == 2
    assert (tmp_path / late).read_text() == "precious"
    assert names(tmp_path) == sorted(["box.urdf", late])


def test_a_card_is_never_there_in_part(tmp_path, monkeypatch):
    """Whoever kills the command at any moment finds a whole card, or none."""
    path, seen = BOX.write(tmp_path), []

    def watch(own, name):
        function = getattr(own, name)

        def watched(*words, **more):
            seen.extend(card.read_text() for card in tmp_path.glob("box.toml"))
            return function(*words, **more)

        monkeypatch.setattr(own, name, watched)

    for name in ("draft_card", "load"):
        watch(robots.models, name)
    for name in ("whole", "prepare"):
        watch(robots, name)
    assert main(["adopt", str(path)]) == 0
    assert len(seen) >= 3
    assert {*seen} == {(tmp_path / "box.toml").read_text()}


def test_refused_robot_leaves_no_file(tmp_path, capsys):
    path = SPIDER.write(tmp_path)
    # a trunk that touches things, and reaches to the floor on which it would stand
    text = path.read_text().replace('contype="0" conaffinity="0"/>\n', "/>\n", 1)
    path.write_text(text.replace('0.02" density', '0.5" density'))
    assert main(["adopt", str(path)]) == 3
    assert names(tmp_path) == ["spider.xml"]


def test_a_refusal_names_the_file_that_was_given_and_none_that_is_gone(
    tmp_path, capsys
):
    path = BOX.write(tmp_path)
    path.write_text(
        path.read_text().replace("<limit", '<dynamics damping="-1"/><limit')
    )
    assert main(["adopt", str(path)]) == 3
    assert f": {path}; joint 'yaw1' has damping = -1" in capsys.readouterr().err
    assert names(tmp_path) == ["box.urdf"]


def test_missing_file_is_refused(tmp_path, capsys):
    assert main(["adopt", str(tmp_path / "gone.xml")]) == 2
    assert "no such robot" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["spider.toml", "spider.png", "box.xml"])
def test_nothing_is_written_through_a_link(tmp_path, capsys, name):
    """Not even through one that leads nowhere, and would make a file there."""
    own, out = tmp_path / "own", tmp_path / "out"
    own.mkdir()
    out.mkdir()
    path = (BOX if name.startswith("box") else SPIDER).write(own)
    (own / name).symlink_to(out / "made")
    assert main(["adopt", str(path)]) == 2
    assert "already exists" in capsys.readouterr().err
    assert names(out) == []
    assert (own / name).is_symlink()


def test_a_robot_that_takes_too_long_is_refused_in_time(tmp_path, capsys, monkeypatch):
    """Its processor time is limited, whatever it is spent on."""
    from models.adoption import draft

    def for_ever(*_):
        while True:
            sum(range(1000))

    monkeypatch.setattr(robots, "BUDGET", 0.5)
    monkeypatch.setattr(draft.anatomy, "find_limbs", for_ever)
    path, began = SPIDER.write(tmp_path), process_time()
    assert main(["adopt", str(path)]) == 3
    assert process_time() - began < 5
    *_, line = capsys.readouterr().err.splitlines()
    assert "no card was found within 0.5 s of processor time" in line
    assert names(tmp_path) == ["spider.xml"]
    assert signal.getitimer(signal.ITIMER_PROF) == (0.0, 0.0)


STRANGE = {
    "no axes": (re.compile(r' axis="[^"]*"'), ""),
    "a leg of a million kilometres": (
        re.compile(r'fromto="0 0 0 [^"]*"'), 'fromto="0 0 0 1e9 0 0"'
    ),
    "legs of no length": (re.compile(r'fromto="[^"]*"'), 'fromto="0 0 0 0 0 -0.1"'),
    "a hexadecimal size": (re.compile(r' size="[^"]*"'), ' size="0x10"'),
    "a turn of 1e300": (re.compile(r'quat="\S+ '), 'quat="1e300 '),
    "parts heavier than anything": (re.compile(r'density="[^"]*"'), 'density="1e200"'),
    "joints upside down": (re.compile(r'axis="0 0 1"'), 'axis="0 0 -1e-300"'),
}  # fmt: skip


@pytest.mark.parametrize(("old", "new"), STRANGE.values(), ids=STRANGE)
@pytest.mark.parametrize(
    ("adoptee", "count"),
    [(FOUR, 0), *(pytest.param(a, 1, marks=pytest.mark.full) for a in (FOUR, SPIDER))],
    ids=["four, all", "four, one", "six, one"],
)
def test_a_strange_robot_is_adopted_or_refused_within_its_budget(
    adoptee, old, new, count, tmp_path, capsys
):
    """One of its parts is strange, or all of them."""
    path, began = adoptee.write(tmp_path), sum(times()[:4])
    path.write_text(old.sub(new, path.read_text(), count=count))
    code = main(["adopt", str(path)])
    assert code in (0, 3)
    assert sum(times()[:4]) - began < 30
    if code:
        assert capsys.readouterr().err.splitlines()[-1].startswith("stratawalk: error")
        assert names(tmp_path) == [path.name]


@pytest.mark.full
def test_a_search_without_end_ends(tmp_path, capsys):
    """Six legs, and a weight beside them: millions of postures are tried to crawl."""
    path, began = Adoptee("six", radial(6), drive="motor").write(tmp_path), times()
    trunk = re.search(r'<geom [^>]*contype="0"[^>]*/>', path.read_text())[0]
    beside = '<geom type="sphere" size="0.01" mass="4.0" pos="0.12 0.09 0"/>'
    path.write_text(path.read_text().replace(trunk, trunk + beside, 1))
    assert main(["adopt", str(path)]) == 3
    assert sum(times()[:4]) - sum(began[:4]) < 40
    *_, line = capsys.readouterr().err.splitlines()
    assert "no card was found within 30 s of processor time" in line
    assert names(tmp_path) == ["six.xml"]


@pytest.mark.parametrize("text", [None, "<mujoco/>"])
def test_a_robot_that_cannot_be_read_leaves_nothing_behind_it(
    text, tmp_path, monkeypatch
):
    """Though its picture was never begun; a file that was there before stays."""
    path = tmp_path / "own.xml"
    if text is None:
        path.write_text("its owner's")
    source = SimpleNamespace(path=path, text=text)
    monkeypatch.setattr(robots.models, "source_of", lambda *_: source)
    draft = SimpleNamespace(card="a = 1")
    monkeypatch.setattr(robots.models, "draft_card", lambda _: draft)

    def load(name, allow_external):
        assert path.with_suffix(".toml").read_text() == "a = 1"
        remove_unfinished()  # as a second signal does
        assert not path.with_suffix(".toml").exists()
        raise ModelError("it has no legs")

    monkeypatch.setattr(robots.models, "load", load)
    options = Namespace(robot="own.urdf", allow_external=False, json=True)
    with pytest.raises(ModelError, match="it has no legs"):
        robots._adopted(options)
    assert [file.name for file in tmp_path.iterdir()] == ["own.xml"] * (text is None)
