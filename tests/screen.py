"""Films decoded, and where a point of the world is on their pictures."""

import subprocess

import imageio_ffmpeg
import numpy as np

from sim.pictures.camera import FIELD_OF_VIEW, HEIGHT, WIDTH

FFMPEG = imageio_ffmpeg.get_ffmpeg_exe()


def on_screen(view, frame, points):
    """Pixels (x, y) at which a camera sees points, by its definition in MuJoCo."""
    turn, tilt = np.radians(view.azimuth[frame]), np.radians(view.elevation)
    forward = np.array(
        [np.cos(turn) * np.cos(tilt), np.sin(turn) * np.cos(tilt), np.sin(tilt)]
    )
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    up = np.cross(right, forward)
    seen = points - (view.target[frame] - view.distance * forward)
    focus = HEIGHT / 2 / np.tan(np.radians(FIELD_OF_VIEW) / 2)
    depth = seen @ forward
    x = WIDTH / 2 + focus * (seen @ right) / depth
    y = HEIGHT / 2 - focus * (seen @ up) / depth
    return np.stack([x, y], axis=-1)


def decode(film):
    """Every picture of a film, shape (pictures, HEIGHT, WIDTH, 3), bytes."""
    raw = ("-f", "rawvideo", "-pix_fmt", "rgb24", "-")
    done = subprocess.run(
        [FFMPEG, "-v", "error", "-i", f"file:{film}", *raw],
        capture_output=True,
        check=True,
    )
    return np.frombuffer(done.stdout, np.uint8).reshape(-1, HEIGHT, WIDTH, 3)
