"""The default tripod gait of RARL's hexapod, as a file for `stratawalk play`.

    python -m scripts.hardware CHECKOUT FILE

reads hips and lengths of the legs from the URDF in a checkout of
github.com/chrismailer/hexapod-sim and writes 5 s of joint angles, 240 a second, with
the parameters of its makers' experiment; docs/hardware.md says what came of it.
"""

import sys
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from planner.support import read_file

URDF = Path("urdf/hexapod_simplified.urdf")
FRAME_RATE, DURATION, PERIOD = 240, 5.0, 1.0  # [1/s], [s], [s]
SPEED, BODY_HEIGHT = 0.3, 0.14  # of the body [m/s], [m]
LEG, FOOT_LIFT = 0.15, 0.05  # of the foot from its hip, and of its lift [m]
TIBIA = 0.14735  # from the knee to the tip, which the URDF has as a mesh [m]
FORWARD = -np.pi / 6  # between two legs [rad]
TURNS = ((1, 0.5), (2, 0.0), (3, 0.5), (4, 0.0), (5, 0.5), (6, 0.0))  # leg, phase


def lengths(checkout: Path) -> tuple[float, float, float]:
    """Length of the coxa and of the femur, and the drop of the hips [m]."""
    root = ElementTree.fromstring(read_file(checkout / URDF).decode())
    origins = {
        joint.get("name"): [float(n) for n in origin.get("xyz", "").split()]
        for joint in root.iter("joint")
        if (origin := joint.find("origin")) is not None
    }
    return origins["joint_1_2"][0], origins["joint_1_3"][0], -origins["joint_1_1"][2]


def foot(leg: int, part: np.ndarray, drop: float) -> np.ndarray:
    """Place of a foot from its hip at parts of a period, (N, 3) [m].

    It goes back on a line at constant speed for half a period, and returns through its
    middle, raised by a step, on the polynomial of degree six that begins and ends at
    rest and without acceleration.
    """
    direction = FORWARD - (leg - 1) * np.pi / 3
    along = np.array([np.cos(direction), np.sin(direction), 0.0])
    half = SPEED * PERIOD / 4
    u = np.clip(2 * part - 1, 0.0, 1.0)
    back = half * (2 * (10 * u**3 - 15 * u**4 + 6 * u**5) - 1)
    way = np.where(part < 0.5, half * (1 - 4 * part), back)
    place: np.ndarray = np.array([LEG, 0.0, drop - BODY_HEIGHT]) + way[:, None] * along
    place[:, 2] += FOOT_LIFT * 64 * (u * (1 - u)) ** 3
    return place


def angles(place: np.ndarray, coxa: float, femur: float) -> np.ndarray:
    """Angles of a leg's three joints, knee up, (N, 3) [rad]."""
    x, y, z = place.T
    out = np.hypot(x, y) - coxa
    bend = (out**2 + z**2 - femur**2 - TIBIA**2) / (2 * femur * TIBIA)
    knee = -np.arccos(np.clip(bend, -1.0, 1.0))
    below = np.arctan2(TIBIA * np.sin(knee), femur + TIBIA * np.cos(knee))
    return np.stack([np.arctan2(y, x), np.arctan2(z, out) - below, knee], axis=1)


def write_gait(checkout: Path, file: Path) -> None:
    """Write the gait of the robot in a checkout to a CSV file."""
    coxa, femur, drop = lengths(checkout)
    time = np.arange(round(DURATION * FRAME_RATE) + 1) / FRAME_RATE
    columns = {"time": time}
    for leg, phase in TURNS:
        place = foot(leg, (time / PERIOD - phase) % 1.0, drop)
        names = (f"joint_{leg}_{number}" for number in (1, 2, 3))
        columns |= zip(names, angles(place, coxa, femur).T, strict=True)
    table, head = np.stack([*columns.values()], axis=1), ",".join(columns)
    np.savetxt(file, table, "%.9g", ",", header=head, comments="")


if __name__ == "__main__":
    write_gait(*map(Path, sys.argv[1:]))
