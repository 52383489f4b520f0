"""Choosing an OpenGL driver, with real trials and with machines that have none."""

import os
import subprocess
import sys

import pytest

from sim.errors import ExitCode, RenderError
from sim.pictures import gl

NO_EGL = {"__EGL_VENDOR_LIBRARY_FILENAMES": os.devnull}  # libEGL without a vendor


@pytest.fixture(autouse=True)
def clean(monkeypatch):
    """No driver asked for, none remembered, before the test and after it."""
    monkeypatch.setenv("MUJOCO_GL", "")
    monkeypatch.delenv(gl.ASKED, raising=False)
    gl._first_that_draws.cache_clear()
    yield
    gl._first_that_draws.cache_clear()


@pytest.fixture
def interpreter(monkeypatch, tmp_path):
    """Replace the Python that trials start by a shell script."""

    def replace(script):
        path = tmp_path / "python"
        path.write_text(f"#!/bin/sh\n{script}\n")
        path.chmod(0o755)
        monkeypatch.setattr(sys, "executable", str(path))

    return replace


def without_egl(monkeypatch):
    for name, value in NO_EGL.items():
        monkeypatch.setenv(name, value)


def test_the_wish_of_the_environment_is_tried_first(monkeypatch):
    tried = []
    monkeypatch.setattr(gl, "_trial", tried.append)
    monkeypatch.setenv("MUJOCO_GL", "osmesa")
    assert gl.probe() == "osmesa"
    assert tried == ["osmesa"]


@pytest.mark.parametrize("value", ["banana", "glfw", "egl", ""])
def test_egl_comes_first_without_a_sensible_wish(monkeypatch, value):
    monkeypatch.setattr(gl, "_trial", lambda backend: None)
    monkeypatch.setenv("MUJOCO_GL", value)
    assert gl.probe() == "egl"


def test_a_trial_is_made_once(monkeypatch):
    tried = []
    monkeypatch.setattr(gl, "_trial", tried.append)
    gl.probe()
    gl.probe()
    assert tried == ["egl"]


@pytest.mark.render
def test_osmesa_draws_where_egl_does_not(monkeypatch):
    if reason := gl._trial("osmesa"):
        pytest.skip(f"osmesa does not draw here: {reason}")
    without_egl(monkeypatch)
    assert gl.probe() == "osmesa"


def test_a_machine_without_drivers_is_told_what_to_install(monkeypatch):
    without_egl(monkeypatch)
    monkeypatch.setattr(gl, "BACKENDS", ("egl",))
    wanted = "cannot draw .*: egl: .*; on Debian: apt-get install libegl1"
    with pytest.raises(RenderError, match=wanted) as error:
        gl.probe()
    assert error.value.exit_code is ExitCode.RENDER
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("value", ["disabled", "OFF", "0"])
def test_pictures_can_be_switched_off(monkeypatch, value):
    monkeypatch.setenv("MUJOCO_GL", value)
    with pytest.raises(RenderError, match=f"switched off: MUJOCO_GL={value.lower()}"):
        gl.probe()


@pytest.mark.parametrize(
    ("script", "reason"),
    [
        ("kill -SEGV $$", "the driver died of signal 11"),
        ("echo 'RuntimeError: it is late. Come back.' >&2; exit 1", "it is late"),
        ("echo \"AttributeError: 'NoneType' object\" >&2; exit 1", "library not found"),
        ("echo 'the picture is blank' >&2; exit 1", "the picture is blank"),
        ("exit 1", "no picture"),
    ],
)
def test_a_failed_trial_says_why(interpreter, script, reason):
    interpreter(script)
    assert gl._trial("egl") == reason


def test_a_trial_that_hangs_is_given_up(interpreter, monkeypatch):
    interpreter("exec sleep 60")
    monkeypatch.setattr(gl, "TRIAL_LIMIT", 0.1)
    assert gl._trial("egl") == "no picture after 0.1 s"


@pytest.mark.parametrize("value", ["banana", "glfw", "egl", "osmesa", None])
def test_physics_imports_mujoco_whatever_the_environment_says(value):
    program = (
        "from sim.pictures import gl; gl.choose(); gl.choose()\n"
        "import sys, mujoco\n"
        "print(sorted({'OpenGL', 'glfw'} & sys.modules.keys()))"
    )
    environment = {**os.environ, **NO_EGL, "PYTHONPATH": str(gl.ROOT)}
    environment.pop("MUJOCO_GL")
    if value is not None:
        environment["MUJOCO_GL"] = value
    done = subprocess.run(
        [sys.executable, "-c", program], env=environment, capture_output=True, text=True
    )
    assert (done.stdout, done.stderr) == ("[]\n", "")


def test_the_wish_outlives_the_silence(monkeypatch):
    monkeypatch.setenv("MUJOCO_GL", "osmesa")
    monkeypatch.setenv(gl.ASKED, "")  # for monkeypatch to undo what choose() does
    monkeypatch.delenv(gl.ASKED)
    gl.choose()
    gl.choose()
    assert os.environ["MUJOCO_GL"] == "disabled"
    assert os.environ[gl.ASKED] == "osmesa"
