"""The doctor says what works here, and gives the command that repairs the rest."""

import importlib
import json
import re
import sys
import tomllib
from base64 import urlsafe_b64encode
from hashlib import sha256
from importlib.metadata import Distribution
from pathlib import Path
from shlex import quote

import pytest

from sim.cli import main
from sim.commands import doctor as packages
from sim.commands.doctor import CHECKS, MUJOCO, Check
from sim.errors import ExitCode, FilesError
from sim.pictures import gl

PROJECT = Path(__file__).resolve().parents[3] / "pyproject.toml"


@pytest.fixture
def examined(capsys, monkeypatch):
    """The doctor's exit code and findings; all packages are as they must be.

    With names given, the other checks are left out.
    """
    monkeypatch.setattr(packages, "differences", lambda: iter(()))

    def run(*names):
        for name in CHECKS.keys() - set(names or CHECKS):
            monkeypatch.delitem(CHECKS, name)
        code = main(["doctor", "--json"])
        return code, json.loads(capsys.readouterr().out)

    return run


@pytest.mark.physics
@pytest.mark.render
@pytest.mark.usefixtures("driver")
def test_everything_works_here(capsys, monkeypatch):
    """Packages apart, whose every file is read for the documented `doctor`."""
    monkeypatch.setattr(packages, "differences", lambda: iter(()))
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
    _, findings = examined("film")
    assert "/bin/false" in findings["film"]["detail"]
    assert "imageio-ffmpeg" in findings["film"]["repair"]


@pytest.mark.physics
def test_a_missing_package_is_to_be_installed(examined, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "matplotlib.figure", None)
    _, findings = examined("figures")
    assert not findings["figures"]["works"]
    assert findings["figures"]["repair"].endswith("--force-reinstall matplotlib")


@pytest.mark.physics
def test_a_report_that_cannot_be_drawn_is_repaired_by_its_own_package(
    examined, monkeypatch
):
    import sim.templates as templates

    def broken(name):
        raise TypeError("no such filter")

    monkeypatch.setattr(templates, "template", broken)
    code, findings = examined("report", "packages")
    assert code == 5
    assert findings["report"]["repair"].endswith("--force-reinstall jinja2")
    assert findings["packages"]["works"]


@pytest.mark.physics
def test_a_film_is_really_made(examined, monkeypatch):
    from sim.pictures import file

    monkeypatch.setattr(file, "count_pictures", lambda film: 0)
    _, findings = examined("film")
    assert "0 of 3 pictures" in findings["film"]["detail"]


@pytest.fixture
def installed(tmp_path, monkeypatch):
    """A package of two files that is installed, and a checkout that pins it."""
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(packages, "PINS", tmp_path)
    content = b"x = 1\n"
    digest = urlsafe_b64encode(sha256(content).digest()).rstrip(b"=").decode()
    (tmp_path / "simple_thing.py").write_bytes(content)
    info = tmp_path / "simple_thing-1.2.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Name: simple-thing\nVersion: 1.2\n")
    record = f"simple_thing.py,sha256={digest},6\n{info.name}/RECORD,,\n"
    (info / "RECORD").write_text(record)
    pin = "simple-thing==1.2 \\\n    --hash=sha256:{}\n".format("0" * 64)
    other = "appnope==1.0 ; sys_platform == 'none'\nabsent-thing==1\n"
    (tmp_path / "constraints.txt").write_text(pin + other)
    return tmp_path


def test_packages_as_they_were_pinned_and_installed_are_as_they_must_be(installed):
    assert list(packages.differences()) == []


def test_a_package_of_another_version_is_told(installed):
    pins = installed / "constraints.txt"
    pins.write_text(pins.read_text().replace("==1.2", "==1.3"))
    told = [("simple-thing==1.3", "simple-thing 1.2, wanted ==1.3")]
    assert list(packages.differences()) == told


@pytest.mark.parametrize("damage", [lambda p: p.write_text("x = 2"), Path.unlink])
def test_a_file_that_was_changed_after_its_installation_is_told(installed, damage):
    damage(installed / "simple_thing.py")
    ((wanted, what),) = packages.differences()
    assert wanted == "simple-thing==1.2"
    assert what == f"{installed / 'simple_thing.py'} is not as it was installed"


@pytest.mark.parametrize(
    "more", [None, b"simple/more.py\n", b"\n", b"\xff,,\n", b'"', b'a,,"1'], ids=str
)
def test_a_package_whose_files_nobody_listed_is_told(installed, more):
    record = installed / "simple_thing-1.2.dist-info" / "RECORD"
    record.write_bytes(record.read_bytes() + more) if more else record.unlink()
    ((wanted, what),) = packages.differences()
    assert wanted == "simple-thing==1.2"
    assert what == "the list of files of simple-thing is not as it was installed"


def test_a_hash_of_a_kind_that_nobody_knows_is_none(installed):
    record = installed / "simple_thing-1.2.dist-info" / "RECORD"
    for kind in ("sha999", "shake_128"):
        record.write_text(re.sub("sha.*?=", f"{kind}=", record.read_text(), count=1))
        ((_, what),) = packages.differences()
        assert what == f"{installed / 'simple_thing.py'} is not as it was installed"


def test_files_of_the_package_itself_are_compared_too(installed, monkeypatch):
    """Where it was installed as a copy, whatever the constraints name."""
    own = Distribution.at(installed / "simple_thing-1.2.dist-info")
    (installed / "simple_thing.py").write_text("x = 2\n")
    monkeypatch.setattr(packages, "distribution", lambda name: own)
    (installed / "constraints.txt").unlink()
    monkeypatch.setattr(own.__class__, "requires", [])
    ((wanted, _),) = packages.differences()
    assert wanted == "stratawalk"


def test_without_pins_the_requirements_of_the_package_count(tmp_path, monkeypatch):
    monkeypatch.setattr(packages, "PINS", tmp_path)
    names = {str(wanted) for wanted in packages._wanted()}
    assert MUJOCO in names
    assert not any("pytest" in name for name in names)


@pytest.mark.physics
def test_packages_that_differ_end_with_6_and_the_command_that_repairs_them(
    examined, monkeypatch
):
    differ = [("numpy==2.0", f"numpy/{i}.py is not as it was") for i in range(5)]
    monkeypatch.setattr(packages, "differences", lambda: iter(differ))
    code, findings = examined("physics", "packages")
    assert code == 6
    found = findings["packages"]
    assert found["detail"].endswith("numpy/2.py is not as it was, and 2 more: packages")
    assert found["repair"].endswith("--force-reinstall --no-deps 'numpy==2.0'")


def test_the_package_itself_is_installed_anew_from_its_checkout(monkeypatch):
    """No index has it, and what else is called so there is none of ours."""
    differ = [("stratawalk", "sim/cli.py is not as it was")]
    monkeypatch.setattr(packages, "differences", lambda: iter(differ))
    with pytest.raises(FilesError) as told:
        packages._packages()
    anew = f"--editable {quote(str(PROJECT.parent))}"
    assert told.value.remedy.endswith(f" --no-deps {anew}")
    gone = Check(lambda: importlib.import_module("sim.gone"), ExitCode.RENDER, "jinja2")
    assert packages._examined(gone).repair.endswith(f" --force-reinstall {anew}")


def test_what_reads_the_requirements_is_installed_anew_where_it_breaks(
    tmp_path, monkeypatch
):
    (tmp_path / "packaging").mkdir()
    (tmp_path / "packaging" / "__init__.py").touch()
    (tmp_path / "packaging" / "requirements.py").write_text("def ((")
    monkeypatch.syspath_prepend(tmp_path)
    for name in ("packaging", "packaging.requirements"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    found = packages._examined(CHECKS["packages"])
    assert "SyntaxError" in found.detail
    assert found.repair.endswith(" --force-reinstall packaging")


def test_the_engine_to_install_is_the_one_required():
    project = tomllib.loads(PROJECT.read_text())["project"]
    assert MUJOCO in project["dependencies"]
