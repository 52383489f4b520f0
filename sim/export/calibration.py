"""Where the servos of a robot are and how they stand, found one servo at a time.

A servo is jogged; its owner says which joint moved, which way, and at which count it
stood at two marked angles. From that follow channel, sign, centre and counts a radian,
counts of the divider that the sketch gives its board, whatever clock was measured.
"""

import re
import sys
from collections.abc import Mapping
from math import degrees, radians
from pathlib import Path

import mujoco
import numpy as np

from models import JointServo, Kinematics, Robot, ServoKind, description, load
from planner import Array
from sim import palette
from sim.errors import RenderError, UsageError, message
from sim.export.servo_commands import ServoCommands
from sim.folder import whole
from sim.pictures import gl
from sim.templates import render

MARK = radians(30)  # of a joint from where it stands, on either side
LIKELY = 0.5  # of the counts a radian of the make; other answers are mistaken
SWING, SECONDS = radians(15), 2.0  # of the strokes that check
WAYS = {"+": 1, "-": -1}
NUMBERS = ("channel", "sign", "center", "offset", "counts_per_radian")
OWN = re.compile(r"""[ \t]*\[[ \t]*(["']?)(servo\1[ \t]*\.|board\1[ \t]*\])""")


def joint_servo(
    kind: ServoKind,
    divider: int,
    channel: int,
    turned: str,
    counts: tuple[int, int],
    angles: tuple[float, float],
) -> JointServo:
    """The servo of a joint that stood at two counts at two angles [rad].

    It turned from the first to the second as counts grew, `+`, or back, `-`. Counts of
    pulses become those of a board that divides its clock by `divider`. Answers that
    cannot be are a ValueError, which says what to look at.
    """
    if turned not in WAYS:
        raise ValueError(f"answer + or -, not {turned!r}")
    if max(counts) >= (most := description.BOARD_COUNTS):
        raise ValueError(f"there are {most} counts, and none is {max(counts)}")
    (first, second), apart = counts, angles[1] - angles[0]
    if (second - first) * WAYS[turned] <= 0:
        raise ValueError(message("turned", turned=turned, first=first, second=second))
    needed, likely = abs(second - first), apart / kind.resolution
    if not LIKELY * likely < needed < likely / LIKELY:
        facts = {"needed": needed, "angle": degrees(apart), "likely": likely}
        raise ValueError(message("unlikely", **facts))
    pulse = kind.signal == "pulse"
    longer = divider / description.board_divider(kind.command_rate) if pulse else 1.0
    return JointServo(
        channel=channel,
        sign=WAYS[turned],
        center=(first + second) / 2 / longer,
        offset=sum(angles) / 2,
        counts_per_radian=needed / apart / longer,
    )


def marks(robot: Robot, joint: str) -> tuple[float, float]:
    """Two angles of a joint that are far apart and within its range [rad]."""
    low, high = robot.span(joint)
    if own := robot.card.joint_servos.get(joint, JointServo()).limits:
        low, high = max(low, own[0]), min(high, own[1])
    middle = min(max(robot.standing_angle(joint), low), high)
    return max(middle - MARK, low), min(middle + MARK, high)


def card_with(
    text: str, servos: Mapping[str, JointServo], clock: float | None, divider: int
) -> str:
    """A card's text with servos, and a measured clock, in place of those it had."""
    lines = [description.without_tables(text, OWN)]
    if clock is not None or divider:
        lines += ["", "[board]"]
    if clock is not None:
        lines += [f"clock = {clock:.0f}  # [Hz], measured"]
    if divider:
        lines += [f"divider = {divider}  # of the clock, for the counts below"]
    for joint, servo in servos.items():
        found = ((name, getattr(servo, name)) for name in NUMBERS)
        numbers = [f"{name} = {x:.8g}" for name, x in found if x is not None]
        limits = [f"limits = {list(servo.limits)}"] if servo.limits else []
        lines += ["", f"[servo.{description.toml_key(joint)}]", *numbers, *limits]
    return "\n".join([*lines, ""])


def require_room(robot: Robot, pulse: bool) -> None:
    """Refuse a card that would be no TOML, or in which ticks would become pulses."""
    card, path = robot.card, robot.path.with_suffix(".toml")
    counted = [j for j, servo in card.mounted.items() if servo.center is not None]
    if counted and pulse != bool(card.board_divider):
        which = "no_pulses" if pulse else "no_ticks"
        raise UsageError.of(which, path, joint=counted[0])
    servos = dict.fromkeys(card.joints, JointServo())
    try:
        text = card_with(robot.card_text, servos, description.BOARD_CLOCK, 4)
        description.parse_toml(text)
    except ValueError as error:
        why = str(error).partition(" (at")[0]
        raise UsageError.of("unwritten", path, why=why) from error


def strokes(robot: Robot, rate: float) -> tuple[ServoCommands, dict[str, str]]:
    """Three strokes that show servos mounted or numbered wrongly, and what to see.

    All legs turn anticlockwise and back; all feet rise and come down; the feet rise one
    after another and come down on their rings of the printed sheet.
    """
    joints, kinematics = robot.card.joints, Kinematics(robot)
    rest = np.array([robot.standing_angle(joint) for joint in joints])
    turn, rise = np.zeros(len(joints)), np.zeros((len(robot.legs), len(joints)))
    for number, leg in enumerate(robot.leg_cards):
        swing = joints.index(leg.swing)
        room = min(abs(end - rest[swing]) for end in robot.span(leg.swing))
        turn[swing] = np.sign(kinematics.hinge(leg.swing)[0][2]) * min(SWING, room)
        rise[number, joints.index(leg.lift)] = leg.raise_sign * robot.card.lift_angle
    moves = [turn, rise.sum(axis=0), *rise]
    slope = np.linspace(0, 1, round(SECONDS * rate))  # to and fro, with a while at both
    bump = np.concatenate([slope, 0 * slope + 1, slope[::-1], 0 * slope])[:, None]
    angles = np.concatenate([rest + move * bump for move in moves])
    each = len(bump) / rate
    meanings = {
        f"0 to {each:.0f} s": "every leg turns anticlockwise, seen from above, and "
        "back; one that turns the other way has a wrong sign",
        f"to {2 * each:.0f} s": "every foot rises and comes down; one that pushes "
        "down has a wrong sign",
        f"to {len(moves) * each:.0f} s": "feet rise in the order of their legs and "
        "come down within their rings, which are a degree of swing in radius",
    }
    return ServoCommands(tuple(joints), rate, angles), meanings


WIDTH, HEIGHT = 420, 300  # of one angle's picture [pixels]
LIMIT = 300.0  # [s]
DISTANCE, ELEVATION = 3.2, -40.0  # of the camera [reach of the robot], [degrees]
ASIDE = 140.0  # from the joint to the camera [degrees]
SHEET_EDGE = 0.02  # around the sheet's feet [m]


def draw(robot: Robot, folder: Path, *, allow_external: bool) -> None:
    """Draw `joint-1.png` for the first joint, and so on; RenderError where nothing can.

    Files have no names of joints, which may be a stranger's.
    """
    words = [str(robot.path), str(folder), *["external"] * allow_external]
    try:
        done = gl.child(gl.probe(), LIMIT, *words, module=__spec__.name)
    finally:  # it may have been killed
        for part in folder.glob(".joint-*.part.png"):
            part.unlink()
    if done.returncode:
        last = (done.stderr.splitlines() or ["no picture"])[-1]
        raise RenderError("cannot draw the joints", last, "go on without pictures")


def _draw(robot: Robot, folder: Path) -> None:
    """At mark 1 on the left and at mark 2 on the right."""
    from PIL import Image, ImageDraw

    from sim.pictures.legend import EDGE, MIDDLE, text

    model, kinematics = robot.model, Kinematics(robot)
    model.vis.global_.offwidth, model.vis.global_.offheight = WIDTH, HEIGHT
    quality = model.vis.quality  # whatever the file asks for
    quality.numslices, quality.numstacks, quality.numquads = 28, 16, 4
    quality.shadowsize, quality.offsamples = 2048, 4
    model.geom_matid[:], model.light_castshadow[:] = -1, False
    data, view = mujoco.MjData(model), mujoco.MjvCamera()
    view.distance, view.elevation = DISTANCE * kinematics.reach, ELEVATION
    floor = model.geom_type[:, None] == mujoco.mjtGeom.mjGEOM_PLANE
    plain = np.where(floor, palette.PAPER.rgba(), palette.OUTLINE.rgba())
    with mujoco.Renderer(model, height=HEIGHT, width=WIDTH) as renderer:
        for number, joint in enumerate(robot.card.joints, 1):
            if (picture := folder / f"joint-{number}.png").exists():
                continue  # of an earlier attempt, or of somebody else
            moved = _carried(model, int(model.joint(joint).bodyid[0]))
            model.geom_rgba[:] = plain
            model.geom_rgba[moved] = palette.group(1).rgba()
            halves = []
            for mark, angle in enumerate(marks(robot, joint), 1):
                data.qpos[:] = kinematics.level_qpos
                data.joint(joint).qpos = angle
                mujoco.mj_forward(model, data)
                place = data.joint(joint).xanchor - data.qpos[:3]
                view.lookat[:] = data.qpos[:3]
                view.azimuth = np.degrees(np.arctan2(place[1], place[0])) + ASIDE
                renderer.update_scene(data, view)
                half = Image.fromarray(renderer.render())
                text(ImageDraw.Draw(half), (EDGE, EDGE), f"mark {mark}", MIDDLE)
                halves.append(np.asarray(half))
            with whole(picture) as part:
                Image.fromarray(np.hstack(halves)).save(part)


def _carried(model: mujoco.MjModel, body: int) -> Array:
    """Geoms of a body and of all that hang on it, shape (n,)."""
    on = [body]
    for child in range(body + 1, model.nbody):
        on += [child] * (model.body_parentid[child] in on)
    return np.flatnonzero(np.isin(model.geom_bodyid, on))


def sheet(robot: Robot) -> str:
    """A sheet in true size: feet in rings of a degree of swing, bearings of horns."""
    kinematics, legs = Kinematics(robot), []
    feet = kinematics.standing.feet
    for (leg, card), foot in zip(robot.card.legs.items(), feet, strict=True):
        hip = kinematics.hinge(card.swing)[1][:2]
        way = foot - hip
        ring, bearing = radians(1) * np.linalg.norm(way), np.arctan2(*way[::-1])
        legs.append((leg, hip, foot, ring, degrees(bearing)))
    low, high = feet.min(axis=0) - 2 * SHEET_EDGE, feet.max(axis=0) + 2 * SHEET_EDGE
    return render("feet.svg", legs=legs, low=low, high=high, corner=low + SHEET_EDGE)


if __name__ == "__main__":
    robot_file, pictures, *external = sys.argv[1:]
    _draw(load(robot_file, allow_external=bool(external)), Path(pictures))
