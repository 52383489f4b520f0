"""The speed at which pictures are drawn with the driver that MUJOCO_GL names.

The trial is a process of its own, because the driver is fixed when mujoco is imported.
It prints the number of pictures drawn in a second.
"""

from __future__ import annotations

import subprocess
import sys
import time

from sim.errors import RenderError
from sim.pictures import gl

PICTURES = 10
LIMIT = 120.0  # [s]


def pictures_per_second(driver: str) -> float:
    """Pictures of the default robot, drafts without captions, that a driver draws.

    Args:
        driver: One that draws, as `gl.probe` finds it.

    Raises:
        RenderError: If it does not draw pictures of this size.
    """
    command = [sys.executable, "-P", "-m", "sim.pictures.drawing_speed"]
    try:
        done = subprocess.run(
            command,
            env=gl.environment(driver),
            capture_output=True,
            text=True,
            errors="replace",
            timeout=LIMIT,
            check=True,
        )
    except (subprocess.CalledProcessError, subprocess.TimeoutExpired) as error:
        where = f"{driver}, {error}"
        raise RenderError("cannot draw pictures", where, gl.INSTALL) from error
    return float(done.stdout)


def _measure() -> float:
    import mujoco  # only here: the driver is tied at this moment

    from models import FOLDER
    from sim.pictures.style import HEIGHT, WIDTH

    spec = mujoco.MjSpec.from_file(str(FOLDER / "hexapod.xml"))
    size = spec.visual.global_
    size.offwidth, size.offheight = WIDTH, HEIGHT
    spec.visual.quality.offsamples = 0
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    with mujoco.Renderer(model, height=HEIGHT, width=WIDTH) as renderer:
        renderer.scene.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = False
        renderer.scene.flags[mujoco.mjtRndFlag.mjRND_REFLECTION] = False
        renderer.scene.flags[mujoco.mjtRndFlag.mjRND_SKYBOX] = False
        renderer.update_scene(data)
        renderer.render()  # the first one is slow
        began = time.perf_counter()
        for _ in range(PICTURES):
            renderer.update_scene(data)
            renderer.render()
    return PICTURES / (time.perf_counter() - began)


if __name__ == "__main__":
    print(_measure())
