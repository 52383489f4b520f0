"""Pictures of a robot with one joint in colour, and a sheet to stand it on.

The pictures are drawn by a process of its own, as films are.
"""

from __future__ import annotations

import sys
from pathlib import Path

import mujoco
import numpy as np

from models import Kinematics, Robot, load
from planner import Array
from sim import palette
from sim.errors import RenderError
from sim.export.calibration import marks
from sim.pictures import gl

WIDTH, HEIGHT = 420, 300  # of one angle's picture [pixels]
LIMIT = 300.0  # [s]
DISTANCE, ELEVATION = 3.2, -40.0  # of the camera [reach of the robot], [degrees]
ASIDE = 140.0  # from the joint to the camera [degrees]
METRE = 1 / 0.0254  # [inch]
SHEET_EDGE = 0.02  # around the sheet's feet [m]


def draw(robot: Robot, folder: Path, *, allow_external: bool) -> None:
    """Draw `JOINT.png` for every joint of the legs; RenderError where nothing can."""
    words = [str(robot.path), str(folder), *(["external"] if allow_external else [])]
    done = gl.child(gl.probe(), LIMIT, *words, module="sim.export.joint_pictures")
    if done.returncode:
        last = (done.stderr.splitlines() or ["no picture"])[-1]
        raise RenderError("cannot draw the joints", last, "go on without pictures")


def _draw(robot: Robot, folder: Path) -> None:
    """At mark 1 on the left and at mark 2 on the right."""
    from PIL import Image

    model, kinematics = robot.model, Kinematics(robot)
    model.vis.global_.offwidth, model.vis.global_.offheight = WIDTH, HEIGHT
    model.geom_matid[:] = -1
    data, view = mujoco.MjData(model), mujoco.MjvCamera()
    view.distance, view.elevation = DISTANCE * kinematics.reach, ELEVATION
    with mujoco.Renderer(model, height=HEIGHT, width=WIDTH) as renderer:
        for joint in robot.card.joints:
            moved = _carried(model, int(model.joint(joint).bodyid[0]))
            model.geom_rgba[:] = palette.OUTLINE.rgba()
            model.geom_rgba[moved] = palette.group(1).rgba()
            halves = []
            for angle in marks(robot, joint):
                data.qpos[:] = kinematics.level_qpos
                data.joint(joint).qpos = angle
                mujoco.mj_forward(model, data)
                place = data.joint(joint).xanchor - data.qpos[:3]
                view.lookat[:] = data.qpos[:3]
                view.azimuth = np.degrees(np.arctan2(place[1], place[0])) + ASIDE
                renderer.update_scene(data, view)
                halves.append(renderer.render())
            Image.fromarray(np.hstack(halves)).save(folder / f"{joint}.png")


def _carried(model: mujoco.MjModel, body: int) -> Array:
    """Geoms of a body and of all that hang on it, shape (n,)."""
    parents, on = model.body_parentid, {body}
    for child in range(body + 1, len(parents)):
        if parents[child] in on:
            on.add(child)
    return np.flatnonzero(np.isin(model.geom_bodyid, list(on)))


def sheet(robot: Robot, path: Path) -> None:
    """A sheet to print at its own size: where feet stand, and how swing horns point.

    A ring is as wide as a degree of the swing joint moves the foot.
    """
    import matplotlib as mpl
    from matplotlib.figure import Figure
    from matplotlib.patches import Circle

    kinematics = Kinematics(robot)
    feet = kinematics.standing.feet
    low = feet.min(axis=0) - 2 * SHEET_EDGE
    high = feet.max(axis=0) + 2 * SHEET_EDGE
    with mpl.rc_context({"svg.hashsalt": palette.BASE_STYLE["svg.hashsalt"]}):
        figure = Figure(figsize=(high - low) * METRE)
        axes = figure.add_axes((0, 0, 1, 1), xlim=(low[0], high[0]))
        axes.set(ylim=(low[1], high[1]), aspect="equal")
        axes.set_axis_off()
        for (leg, card), foot in zip(robot.card.legs.items(), feet, strict=True):
            hip = kinematics.anchor(card.swing)[:2]
            degree = np.radians(1) * np.linalg.norm(foot - hip)
            axes.add_patch(Circle(foot, degree, fill=False))
            axes.plot(*np.array([hip, foot]).T, linewidth=0.5, color="0.5")
            angle = np.degrees(np.arctan2(*(foot - hip)[::-1]))
            axes.annotate(f"leg {leg}, {angle:.0f}°", foot + (0.004, 0.004), size=8)
        corner = low + SHEET_EDGE
        axes.plot(*np.transpose([corner, corner + (0.05, 0)]), color="k")
        axes.annotate("50 mm ahead; print at 100 %", corner + (0, 0.002), size=8)
        figure.savefig(path, metadata={"Date": None})


if __name__ == "__main__":
    robot_file, pictures, *external = sys.argv[1:]
    _draw(load(robot_file, allow_external=bool(external)), Path(pictures))
