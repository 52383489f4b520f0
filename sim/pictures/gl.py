"""The choice of an OpenGL driver, EGL first and OSMesa second, and its speed.

MuJoCo binds its driver at `import mujoco`, which fails if MUJOCO_GL does not suit the
machine. The physics therefore imports MuJoCo without a driver, and pictures are drawn
by separate processes that are started with the driver found here.
"""

import os
import subprocess
import sys
import time
from functools import cache

from sim.errors import ROOT, RenderError

BACKENDS = ("egl", "osmesa")  # in the order they are tried
ASKED = "STRATAWALK_GL"  # what MUJOCO_GL said before physics silenced it
TRIAL_LIMIT = 60.0  # [s]; a trial takes 0.5 s
INSTALL = "on Debian: apt-get install libegl1 libopengl0 libgl1-mesa-dri"
SPEED = "speed"  # what a child process is asked to measure
PICTURES = 10  # that it draws


def choose() -> None:
    """Keep drivers out of this process, whatever the value of MUJOCO_GL.

    Must be called before mujoco is imported. The value is kept for the processes that
    draw: `osmesa` is then tried first, `disabled` forbids pictures, others are ignored.
    """
    os.environ.setdefault(ASKED, os.environ.get("MUJOCO_GL", ""))
    os.environ["MUJOCO_GL"] = "disabled"


def probe() -> str:
    """The first driver that draws a frame on this machine, tested in a child process.

    Costs half a second the first time and nothing afterwards. RenderError if there is
    none, or if MUJOCO_GL switches pictures off.
    """
    asked = os.environ.get(ASKED, os.environ.get("MUJOCO_GL", "")).strip().lower()
    if asked in ("disable", "disabled", "off", "false", "0"):  # as MuJoCo spells it
        raise RenderError.of("no_pictures", f"MUJOCO_GL={asked}", to=BACKENDS[0])
    return _first_that_draws(tuple(sorted(BACKENDS, key=lambda name: name != asked)))


def environment(backend: str) -> dict[str, str]:
    """Environment of a Python process that draws with `backend` and runs this code."""
    path = os.pathsep.join(filter(None, (str(ROOT), os.environ.get("PYTHONPATH"))))
    gl = {"MUJOCO_GL": backend, "PYOPENGL_PLATFORM": backend, "PYTHONPATH": path}
    return {**os.environ, **gl}


def pictures_per_second(driver: str) -> float:
    """Pictures of the default robot, drafts without captions, drawn in a second."""
    try:
        done = child(driver, 120.0, SPEED)  # [s]
        done.check_returncode()
    except (subprocess.CalledProcessError, subprocess.TimeoutExpired) as error:
        where = f"{driver}, {error}"
        raise RenderError("cannot draw pictures", where, INSTALL) from error
    return float(done.stdout)


def child(
    driver: str, limit: float, *asked: str, module: str = "sim.pictures.gl"
) -> subprocess.CompletedProcess[str]:
    """A module as a process of its own that draws with a driver, in so many seconds."""
    return subprocess.run(
        [sys.executable, "-P", "-m", module, *asked],
        env=environment(driver),
        capture_output=True,
        text=True,
        errors="replace",
        timeout=limit,
    )


@cache
def _first_that_draws(backends: tuple[str, ...]) -> str:
    reasons = []
    for backend in backends:
        if not (reason := _trial(backend)):
            return backend
        reasons.append(f"{backend}: {reason}")
    where = "; ".join(reasons)
    raise RenderError("cannot draw pictures without a screen", where, INSTALL)


def _trial(backend: str) -> str | None:
    """The reason why a driver does not draw, in a few words; None if it draws."""
    try:
        trial = child(backend, TRIAL_LIMIT)
    except subprocess.TimeoutExpired:
        return f"no picture after {TRIAL_LIMIT:g} s"
    if trial.returncode == 0:
        return None
    if trial.returncode < 0:
        return f"the driver died of signal {-trial.returncode}"
    lines = [s for s in trial.stderr.splitlines() if s and not s[0].isspace()]
    last = lines[-1] if lines else "no picture"  # of a traceback
    if "NoneType" in last:  # PyOpenGL found no library and went on with None
        return "library not found"
    return last.partition(": ")[2].partition(". ")[0] or last


def _draw_one_frame() -> None:
    """Draw a lit ball, and see that the picture is neither empty nor flat."""
    import mujoco  # only here: the driver is tied at this moment

    world = "<worldbody><light pos='0 0 3'/><geom size='1'/></worldbody>"
    model = mujoco.MjModel.from_xml_string(f"<mujoco>{world}</mujoco>")
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    with mujoco.Renderer(model, height=24, width=32) as renderer:
        renderer.update_scene(data)
        picture = renderer.render()
    if picture.min() == picture.max():
        raise SystemExit("the picture is blank")


def _measure() -> float:
    import mujoco  # only here: the driver is tied at this moment

    from models.description import FOLDER
    from sim.pictures.camera import HEIGHT, WIDTH

    spec = mujoco.MjSpec.from_file(str(FOLDER / "hexapod.xml"))
    spec.visual.global_.offwidth, spec.visual.global_.offheight = WIDTH, HEIGHT
    spec.visual.quality.offsamples = 0
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    with mujoco.Renderer(model, height=HEIGHT, width=WIDTH) as renderer:
        flag = mujoco.mjtRndFlag
        for part in (flag.mjRND_SHADOW, flag.mjRND_REFLECTION, flag.mjRND_SKYBOX):
            renderer.scene.flags[part] = False
        renderer.update_scene(data)
        renderer.render()  # the first one is slow
        began = time.perf_counter()
        for _ in range(PICTURES):
            renderer.update_scene(data)
            renderer.render()
    return PICTURES / (time.perf_counter() - began)


if __name__ == "__main__":
    print(_measure()) if SPEED in sys.argv else _draw_one_frame()
