"""Whatever ends a process, finished points stay finished and torn lines do no harm."""

import json
import os
import signal
import time
from contextlib import nullcontext
from dataclasses import replace

import pytest

from models import MeasurementError
from sim.errors import FilesError, UsageError, one_line
from sim.sweeps.folder import sole_owner
from sim.sweeps.ledger import DIED, OK, Outcome, _sealed, opened, read_ledger
from tests.commands import FORKS

FIRST, SECOND = (Outcome(code, OK, {"x": 0.1}, {"mujoco": "1"}) for code in "ab")


def test_what_was_added_is_read_again_to_the_last_digit(tmp_path):
    third = Outcome("c", "no plan: none", {"x": 1 / 3})
    with opened(tmp_path / "ledger") as ledger:
        ledger.add([FIRST, SECOND])
        ledger.add([third])
    known = read_ledger(tmp_path / "ledger")
    assert known == {"a": FIRST, "b": SECOND, "c": third}


@pytest.mark.parametrize("cut", [1, 20, 60])
def test_a_torn_last_line_is_cut_off_and_nothing_else_is_lost(tmp_path, cut):
    path = tmp_path / "ledger"
    with opened(path) as ledger:
        ledger.add([FIRST, SECOND])
    path.write_bytes(path.read_bytes()[:-cut])
    assert read_ledger(path) == {"a": FIRST}
    with opened(path) as ledger:
        ledger.add([SECOND])
    assert read_ledger(path) == {"a": FIRST, "b": SECOND}
    assert all(json.loads(line) for line in path.read_text().splitlines())


@pytest.mark.parametrize("text", ['{"my": "data"}', '{"sea', "notes", "\0" * 512])
def test_text_of_others_is_no_torn_line_of_ours(tmp_path, text):
    """As JSON is written without a line end: it would be cut off to nothing."""
    path = tmp_path / "ledger"
    path.write_text(text)
    if text[0] == "\0" or text == '{"sea':  # as a disk that lost its power has it
        assert read_ledger(path) == {}
        return
    with pytest.raises(UsageError, match="line 1 is not as a sweep wrote it"):
        read_ledger(path)


def edited(path, old, new):
    """A ledger of two points in which some text is replaced."""
    with opened(path) as ledger:
        ledger.add([FIRST, SECOND])
    text = path.read_bytes()
    assert old in text
    path.write_bytes(text.replace(old, new))


@pytest.mark.parametrize(
    ("old", "new"),
    [(b"0.1", b"0.2"), (b'{"x": 0.1}', b"5"), (b'"ok"', b'"ko"'), (b'"a"', b'"c"'),
     (b'{"seal": ', b""), (b"\n", b"\n\n"), (b"0.1", b"0.1" + b" " * 10**6)],
)  # fmt: skip
def test_a_line_that_was_changed_is_refused_with_its_number(tmp_path, old, new):
    path = tmp_path / "ledger"
    edited(path, old, new)
    with pytest.raises(
        UsageError, match="line [12] is not as a sweep wrote it"
    ) as said:
        read_ledger(path)
    assert str(path) in str(said.value)
    assert "--resume walks its point again" in str(said.value)


@pytest.mark.parametrize(
    "content",
    [
        b"5", b"{}", b"[1]", b"{" * 10**5,
        b'{"digest": "a", "status": "ok", "numbers": 5}',
        b'{"digest": "a", "status": 1}',
        b'{"digest": "a", "status": "ok", "numbers": {"x": NaN}}',
        b'{"digest": "a", "status": "ok", "numbers": {"x": [1]}}',
        b'{"digest": "a", "status": "ok", "numbers": {"x": 99999999999999999999}}',
        b'{"digest": "a", "status": "ok", "software": ["x"]}',
        b'{"digest": "a", "status": "\\udcff"}',
        b'{"digest": "a", "status": ""}', b'{"digest": "a", "status": "a: b\\n"}',
        b'{"digest": "a", "status": "a: \\u001b[2J"}',
        b'{"digest": "a", "status": "ok", "numbers": {"x": "\\udcff"}}',
        b'{"digest": "a", "status": "ok", "numbers": {"\\udcff": 1}}',
    ],
)  # fmt: skip
def test_a_seal_alone_makes_no_outcome(tmp_path, content):
    path = tmp_path / "ledger"
    path.write_bytes(_sealed(content))
    with pytest.raises(UsageError, match="line 1 is not as a sweep wrote it"):
        read_ledger(path)


def test_whatever_a_point_fails_of_is_kept_in_its_words(tmp_path):
    """Refusals without a place, and long ones, which are cut between words."""
    errors = MeasurementError("it tips over"), UsageError("x " * 999, "", "go")
    said = [Outcome(str(i), one_line(error)) for i, error in enumerate(errors)]
    (path := tmp_path / "ledger").write_bytes(b"".join(one.line for one in said))
    assert [*read_ledger(path).values()] == said


def test_nothing_is_written_through_the_links_of_a_stranger(tmp_path):
    mine = tmp_path / "mine"
    mine.write_text("mine")
    (tmp_path / "x.owner").symlink_to(mine)
    with sole_owner(tmp_path / "x.lock"):
        assert mine.read_text() == "mine"
    (tmp_path / "ledger").symlink_to(tmp_path / "new")
    with (
        pytest.raises(FilesError, match="cannot be opened"),
        opened(tmp_path / "ledger"),
    ):
        pass
    assert not (tmp_path / "new").exists()


def test_a_missing_ledger_knows_no_points(tmp_path):
    assert read_ledger(tmp_path / "ledger") == {}


def hold(path, held):
    with sole_owner(path):
        held.set()
        time.sleep(600)


@pytest.fixture
def owner(tmp_path):
    """Another process that holds the lock of a folder."""
    held = FORKS.Event()
    process = FORKS.Process(target=hold, args=(tmp_path / "x.lock", held))
    process.start()
    assert held.wait(60)
    yield process
    process.kill()
    process.join(60)


def test_a_second_process_is_refused_and_told_of_the_first(tmp_path, owner):
    with (
        pytest.raises(FilesError, match=f"process {owner.pid} on .* is working"),
        sole_owner(tmp_path / "x.lock"),
    ):
        pass


def test_the_lock_of_a_killed_process_is_free_and_no_longer_its_own(tmp_path, owner):
    os.kill(owner.pid, signal.SIGKILL)
    owner.join(60)
    name = tmp_path / "x.owner"
    assert json.loads(name.read_text())["pid"] == owner.pid
    with sole_owner(tmp_path / "x.lock"):
        assert json.loads(name.read_text())["pid"] == os.getpid()
    assert not name.exists()


def test_work_that_fails_leaves_no_name_of_an_owner(tmp_path):
    with pytest.raises(UsageError), sole_owner(tmp_path / "x.lock"):
        raise UsageError("begun with something else", "x", "choose another folder")
    assert not (tmp_path / "x.owner").exists()


def test_two_results_of_a_point_are_refused_by_its_number(tmp_path):
    paths = tmp_path / "one", tmp_path / "other"
    second = replace(FIRST, numbers={"x": 0.2})
    for path, outcome in zip(paths, (FIRST, second), strict=True):
        with opened(path) as ledger:
            ledger.add([outcome])
    assert read_ledger(paths[0], paths[0]) == {"a": FIRST}
    said = "other; |point 7 has two results, x: 0.1, now 0.2"
    with pytest.raises(UsageError, match=said):
        read_ledger(*paths, points={"a": 7})


def test_more_than_any_sweep_has_is_refused_by_the_line(tmp_path, monkeypatch):
    """It would take gigabytes."""
    with opened(tmp_path / "ledger") as ledger:
        ledger.add(
            [FIRST, replace(SECOND, numbers=dict.fromkeys(map(str, range(99)), 0))]
        )
    assert len(read_ledger(tmp_path / "ledger")) == 2
    monkeypatch.setattr("sim.sweeps.ledger.LARGEST_LEDGER", 20_000)
    said = "line 2 is .*, no sweep has so many points or"
    with pytest.raises(UsageError, match=said):
        read_ledger(tmp_path / "ledger")


def test_numbers_that_no_sweep_has_as_many_of_are_refused(tmp_path, monkeypatch):
    """Each name is a column of the table, of all points, whoever has a number there."""
    monkeypatch.setattr("sim.sweeps.ledger.LARGEST_LEDGER", 10**6)
    names = [f"x{n}" for n in range(200)]
    for own, path in ((names[:100], tmp_path / "one"), (names[100:], tmp_path / "two")):
        first = replace(FIRST, numbers=dict.fromkeys(names[:100], 0))
        second = replace(SECOND, numbers=dict.fromkeys(own, 0))
        with opened(path) as ledger:
            ledger.add([first, second])
    assert len(read_ledger(tmp_path / "one")) == 2
    with pytest.raises(UsageError, match="line 2 is .*, no sweep has so many"):
        read_ledger(tmp_path / "two")


def test_a_table_of_many_points_and_many_numbers_is_refused(tmp_path, monkeypatch):
    """200 lines take 38 kB each, 300 names 6 kB each, and each place in both 20."""
    numbers = {f"x{n:03d}": 0 for n in range(300)}
    outcomes = [replace(FIRST, digest=str(n), numbers=numbers) for n in range(200)]
    with opened(tmp_path / "ledger") as ledger:
        ledger.add(outcomes)
    for most, said in ((10**7, "no sweep has so many"), (1.2e7, "")):
        monkeypatch.setattr("sim.sweeps.ledger.LARGEST_LEDGER", most)
        with pytest.raises(UsageError, match=said) if said else nullcontext():
            assert len(read_ledger(tmp_path / "ledger")) == 200


def test_results_of_no_point_of_a_sweep_are_left_out(tmp_path):
    with opened(tmp_path / "ledger") as ledger:
        ledger.add([FIRST, SECOND])
    assert read_ledger(tmp_path / "ledger", points={"b": 0}) == {"b": SECOND}
    assert read_ledger(tmp_path / "ledger", points={}) == {}


@pytest.mark.parametrize("order", [(0, 1), (1, 0), (1, 1, 0), (1, 0, 1)])
def test_a_result_takes_the_place_of_the_death_of_a_worker(tmp_path, order):
    outcomes = FIRST, replace(FIRST, status=f"{DIED}: once", numbers={})
    with opened(tmp_path / "x") as ledger:
        ledger.add(outcomes[number] for number in order)
    assert read_ledger(tmp_path / "x") == {"a": FIRST}


def test_a_line_of_other_software_is_refused_where_it_must_be_alike(tmp_path):
    path = tmp_path / "ledger"
    with opened(path) as ledger:
        ledger.add([FIRST])
    assert read_ledger(path, software={"mujoco": "1", "python": "2"}) == {"a": FIRST}
    with pytest.raises(UsageError, match='of other software, mujoco: "2", now "1"'):
        read_ledger(path, software={"mujoco": "2"})


@pytest.mark.parametrize("lose", ["remove", "rename", "replace"])
def test_a_ledger_that_is_no_longer_there_is_told_at_once(tmp_path, lose):
    """Not after days of walking points that nobody keeps."""
    path = tmp_path / "folder" / "ledger"
    path.parent.mkdir()
    with opened(path) as ledger:
        ledger.add([FIRST])
        if lose == "replace":  # as editors do
            path.unlink()
            path.touch()
        else:
            path.unlink() if lose == "remove" else path.parent.rename(tmp_path / "b")
        with pytest.raises(FilesError, match="the ledger was moved, removed or repl"):
            ledger.add([SECOND])


def test_a_status_is_as_long_as_what_is_said_of_errors():
    assert Outcome("a", "x" * 2000).status
    with pytest.raises(TypeError, match="no message of one line"):
        Outcome("a", "x" * 2001)
