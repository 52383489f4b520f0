"""The doctor says what works here, and gives the command that repairs the rest."""

import json
import tomllib
from pathlib import Path

import pytest

from sim.cli import main
from sim.commands.doctor import CHECKS, MUJOCO
from sim.pictures import gl

PROJECT = Path(__file__).resolve().parents[3] / "pyproject.toml"


@pytest.fixture
def examined(capsys):
    """The doctor's exit code and findings."""

    def run():
        code = main(["doctor", "--json"])
        return code, json.loads(capsys.readouterr().out)

    return run


@pytest.mark.physics
@pytest.mark.render
@pytest.mark.usefixtures("driver")
def test_everything_works_here(capsys):
    assert main(["doctor"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[:2] for line in lines] == [[name, "works"] for name in CHECKS]
    assert "steps a second" in lines[0]
    assert "pictures a second" in lines[1]


@pytest.mark.physics
def test_pictures_switched_off_end_with_5_and_a_way_back(examined, monkeypatch):
    monkeypatch.setenv(gl.ASKED, "off")
    code, findings = examined()
    assert code == 5
    assert findings["rendering"]["repair"].startswith("unset MUJOCO_GL")
    assert findings["physics"]["works"]
    assert findings["film"]["works"]


@pytest.mark.physics
def test_an_encoder_that_fails_is_named_with_its_repair(examined, monkeypatch):
    monkeypatch.setenv("IMAGEIO_FFMPEG_EXE", "/bin/false")
    monkeypatch.setenv(gl.ASKED, "off")
    _, findings = examined()
    assert "/bin/false" in findings["film"]["detail"]
    assert "imageio-ffmpeg" in findings["film"]["repair"]


@pytest.mark.physics
def test_a_missing_package_is_to_be_installed(examined, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "matplotlib.figure", None)
    monkeypatch.setenv(gl.ASKED, "off")
    _, findings = examined()
    assert not findings["figures"]["works"]
    assert findings["figures"]["repair"].endswith("--force-reinstall matplotlib")


@pytest.mark.physics
def test_a_report_that_cannot_be_drawn_is_repaired_by_its_own_package(
    examined, monkeypatch
):
    import sim.reports.templates as templates

    def broken(name):
        raise TypeError("no such filter")

    monkeypatch.setattr(templates, "template", broken)
    monkeypatch.setenv(gl.ASKED, "off")
    code, findings = examined()
    assert code == 5
    assert findings["report"]["repair"].endswith("--force-reinstall jinja2")
    assert findings["film"]["works"]


@pytest.mark.physics
def test_a_film_is_really_made(examined, monkeypatch):
    from sim.pictures import file

    monkeypatch.setattr(file, "count_pictures", lambda film: 0)
    monkeypatch.setenv(gl.ASKED, "off")
    _, findings = examined()
    assert "0 of 3 pictures" in findings["film"]["detail"]


def test_the_engine_to_install_is_the_one_required():
    project = tomllib.loads(PROJECT.read_text())["project"]
    assert MUJOCO in project["dependencies"]
