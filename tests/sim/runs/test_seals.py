"""Which files of a run are sealed, and with what."""

import hashlib
from pathlib import Path

import pytest

from sim.runs.seals import CARD, MAKE, TABLES, WHOLE, seal, seals

COPIES = ["robot/mine.xml", "assets/leg.obj"]


def test_copies_of_a_robot_s_files_are_sealed_and_sealed_again(tmp_path):
    for name in COPIES:
        (tmp_path / name).parent.mkdir()
        (tmp_path / name).write_text(name)
    found = seals(tmp_path, {}, {}, {}, copies=COPIES)
    assert set(found) == {*TABLES, MAKE, *WHOLE, *COPIES}
    for name in COPIES:
        assert found[name] == hashlib.sha256(name.encode()).hexdigest()[:16]
    (tmp_path / COPIES[1]).write_text("another leg")
    again = seals(tmp_path, {}, {}, {"seals": found})
    assert {name for name in found if again[name] != found[name]} == {COPIES[1]}


def test_seals_of_files_elsewhere_are_none(tmp_path):
    told = {"seals": {"../x": "0", "/etc/hostname": "0", "robot/../../x": "0"}}
    assert set(seals(tmp_path, {}, {}, told)) == {*TABLES, *WHOLE} - {CARD}


def test_servos_may_be_mounted_anew_and_legs_may_not(tmp_path):
    card = {"lift_angle": 0.3, "servo": {"kind": "mg90"}, "board": {"clock": 25e6}}
    servo = {"kind": "mg90", "lift_1": {"channel": 3}}
    anew = {"servo": servo, "board": {"clock": 26e6}, "description": "it"}
    sealed = seals(tmp_path, {}, card, {})
    assert seals(tmp_path, {}, card | anew, {}) == sealed
    earlier = seals(tmp_path, {}, card, {"seals": {"model.toml": sealed[CARD]}})
    assert earlier.keys() == sealed.keys() - {MAKE}
    other = {"servo": servo | {"kind": "mg996r"}}  # its commands would be others
    assert seals(tmp_path, {}, card | other, {}) != sealed
    assert seals(tmp_path, {}, card | {"lift_angle": 0.2}, {}) != sealed


def test_what_a_summary_names_is_digested_once_and_up_to_a_limit(tmp_path, monkeypatch):
    """A file by many names, or many large ones, would take hours."""
    monkeypatch.setattr("sim.runs.seals.LARGEST_SEALED", 15)
    for name in "ab":
        (tmp_path / name).write_text("ten bytes.")
    told = dict.fromkeys(["a", "./a", ".//a", "x/../a", "b"], "0")
    found = seals(tmp_path, {}, {}, {"seals": told})
    assert found.keys() & told.keys() == {"a", "b"}
    assert (bool(found["a"]), found["b"]) == (True, None)


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="no /proc here")
def test_a_file_without_a_size_is_not_read_to_an_end_that_may_not_come(tmp_path):
    """As those of /proc are, of which some have none."""
    (tmp_path / "empty").touch()
    (tmp_path / "link").symlink_to("/proc/self/status")
    assert (tmp_path / "link").read_bytes()
    assert seal(tmp_path / "link") == seal(tmp_path / "empty")
