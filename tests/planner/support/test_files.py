"""Files are whole or absent, whatever happens while they are written."""

import errno
import os
import subprocess
import sys
from contextlib import nullcontext
from pathlib import Path
from types import SimpleNamespace

import pytest

from planner.support import files
from planner.support.files import (
    read_file,
    read_text,
    remove_unfinished,
    require_space,
    unfinished,
    whole_file,
)


def names(folder):
    return sorted(entry.name for entry in folder.iterdir())


def test_file_has_its_name_when_the_block_ends_and_not_before(tmp_path):
    with whole_file(tmp_path / "plan.json") as part:
        part.write_text("all of it")
        assert part.suffix == ".json"
        assert names(tmp_path) == [part.name] != ["plan.json"]
    assert names(tmp_path) == ["plan.json"]
    assert (tmp_path / "plan.json").read_text() == "all of it"


@pytest.mark.parametrize("number", ["EPERM", "EOPNOTSUPP", "ENOSYS"])
def test_a_new_file_needs_no_links(tmp_path, monkeypatch, number):
    """Shares of other machines, and drives of programs, have none."""

    def link(*_):
        raise OSError(getattr(errno, number), "no links")

    def write():
        with whole_file(tmp_path / "new.csv", new=True) as part:
            part.write_text("mine")

    monkeypatch.setattr(os, "link", link)
    write()
    assert names(tmp_path) == ["new.csv"]
    monkeypatch.undo()
    with pytest.raises(FileExistsError):
        write()


def test_what_would_be_waited_for_is_read_as_empty(monkeypatch):
    """As the messages of a kernel are, while there are none."""
    nothing = SimpleNamespace(read=lambda size: None)
    monkeypatch.setattr(files, "open_file", lambda path: nullcontext(nothing))
    assert read_file("kmsg") == b""


def test_block_that_fails_leaves_the_file_that_was_there(tmp_path):
    (tmp_path / "plan.json").write_text("before")

    def write_half():
        with whole_file(tmp_path / "plan.json") as part:
            part.write_text("half")
            raise ZeroDivisionError

    pytest.raises(ZeroDivisionError, write_half)
    assert names(tmp_path) == ["plan.json"]
    assert (tmp_path / "plan.json").read_text() == "before"


def test_process_that_dies_halfway_leaves_no_file_under_its_name(tmp_path):
    program = (
        "import os, planner.support\n"
        f"with planner.support.whole_file({str(tmp_path / 'a.txt')!r}) as part:\n"
        "    part.write_text('half')\n"
        "    os._exit(9)\n"
    )
    assert subprocess.run([sys.executable, "-c", program]).returncode == 9
    assert "a.txt" not in names(tmp_path)


def test_a_link_that_waits_under_the_name_of_a_part_is_not_written_through(tmp_path):
    with whole_file(tmp_path / "a.txt") as part:
        part.write_text("first")
    part.symlink_to("victim")  # as a foreign folder may hold, if it could be guessed
    with whole_file(tmp_path / "a.txt") as part:
        part.write_text("second")
    assert not (tmp_path / "victim").exists()
    assert (tmp_path / "a.txt").read_text() == "second"


@pytest.mark.parametrize("name", ["absent/a.json", "file/a.json", "."])
def test_refusal_names_the_file_and_not_the_part(tmp_path, name):
    (tmp_path / "file").touch()
    path = tmp_path / name
    with (
        pytest.raises(OSError, match="a directory|file or dir|busy") as refusal,
        whole_file(path) as part,
    ):
        part.write_text("text")
    assert refusal.value.filename == str(path)


def test_disk_that_is_too_small_is_refused_before_the_work(tmp_path):
    require_space(tmp_path, 1000)
    with pytest.raises(OSError, match=os.strerror(errno.ENOSPC)) as refusal:
        require_space(tmp_path, 10**18)
    assert refusal.value.errno == errno.ENOSPC
    with pytest.raises(OSError, match="a.txt"), whole_file(tmp_path / "a.txt", 10**18):
        pytest.fail("there is no room for it")
    assert names(tmp_path) == []


def test_a_disk_that_does_not_say_its_size_is_written_to():
    require_space(Path("/proc"), 1000)


def test_a_file_is_read_as_far_as_it_may_be_long(tmp_path):
    path = tmp_path / "text"
    path.write_bytes(b"12345")
    assert read_file(path, 5) == b"12345"
    with pytest.raises(OSError, match="larger than 4e-06 MB"):
        read_file(path, 4)


@pytest.mark.parametrize("name", ["pipe", "folder", "device", "none", "a\0"])
def test_what_is_no_file_is_not_waited_for(tmp_path, name):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "folder").mkdir()
    (tmp_path / "device").symlink_to("/dev/zero")
    with pytest.raises(OSError, match="not a|not the|directory|No such") as refused:
        read_file(tmp_path / name)
    assert refused.value.filename == str(tmp_path / name)


def test_a_text_is_read_without_its_mark_and_only_in_utf_8(tmp_path):
    path = tmp_path / "scenario.toml"
    path.write_bytes("\ufeffname = 'é'".encode())
    assert read_text(path) == "name = 'é'"
    path.write_bytes(b"\nname = '\xe9'")
    with pytest.raises(ValueError, match="^line 2 is no text in UTF-8, as it must be"):
        read_text(path)


@pytest.mark.parametrize("letter", ["x", "\N{GRINNING FACE}"])
def test_names_of_any_length_that_a_disk_takes_are_written(tmp_path, letter):
    stem = letter * ((255 - len(".json")) // len(letter.encode()))
    with whole_file(tmp_path / f"{stem}.json") as part:
        part.write_text("all of it")
    assert names(tmp_path) == [f"{stem}.json"]


def write_several(folder):
    (folder / "pieces").mkdir()
    for name in ("card.toml", "pieces/0.mp4"):
        (folder / name).write_text("half")
    return folder / "card.toml", folder / "pieces", folder / "never"


def test_files_and_folders_of_work_that_fails_are_removed(tmp_path):
    (tmp_path / "other").touch()
    with pytest.raises(KeyboardInterrupt), unfinished(*write_several(tmp_path)):
        raise KeyboardInterrupt
    assert names(tmp_path) == ["other"]


def test_files_and_folders_of_unfinished_work_are_removed_before_an_end(tmp_path):
    with unfinished(*write_several(tmp_path)):
        remove_unfinished()
        assert names(tmp_path) == []
        write_several(tmp_path)
    remove_unfinished()
    assert names(tmp_path) == ["card.toml", "pieces"]
