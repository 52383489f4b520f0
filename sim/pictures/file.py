"""Films as files: encoded in pieces, joined, and checked by counting pictures.

An encoder that dies leaves a file that seems valid, or none at all, and reports
success; only the number of pictures shows the failure.
"""

import errno
import os
import subprocess
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import imageio_ffmpeg

from planner import Array
from sim.errors import RenderError, telling
from sim.pictures.clock import FRAME_RATE

CODEC = "libx264"
QUALITY = ("-preset", "superfast", "-crf", "22", "-threads", "1")
# Fragments keep a piece readable up to where its encoder died.
FRAGMENTS = ("-movflags", "+frag_keyframe+empty_moov+default_base_moof", "-g", "30")
# A tenth of the data of the film itself; shown for ever.
SMALLER = ("-vf", "fps=10,scale=640:-2:flags=lanczos", "-q:v", "46")
WEBP = ("-c:v", "libwebp_anim", "-compression_level", "6", "-loop", "0", "-f", "webp")
FULL = "No space left"  # how ffmpeg reports it
INSTALL = "pip install --force-reinstall imageio-ffmpeg, and unset IMAGEIO_FFMPEG_EXE"


def check_encoder() -> None:
    """Test whether films can be encoded on this machine, or raise RenderError."""
    if f"Encoder {CODEC} " not in _ffmpeg("-h", f"encoder={CODEC}"):
        raise RenderError(f"cannot encode {CODEC}", _executable(), INSTALL)


@contextmanager
def encoding(path: Path) -> Iterator[Callable[[Array], object]]:
    """A function that appends a picture; OSError if the encoder dies."""
    import imageio.v2 as imageio  # half a second that only processes that draw spend

    options = {
        "fps": FRAME_RATE,
        "codec": CODEC,
        "quality": None,
        "macro_block_size": 2,
        "ffmpeg_log_level": "error",
        "output_params": [*QUALITY, *FRAGMENTS],
    }
    try:
        with imageio.get_writer(path, format="FFMPEG", **options) as writer:  # type: ignore
            yield writer.append_data  # type: ignore[attr-defined]
    except OSError as error:  # its message is the command line, on several lines
        raise OSError("the encoder died") from error


def join(pieces: Sequence[Path], film: Path) -> None:
    """Join pieces, films in one folder, without encoding them again."""
    contents = pieces[0].with_name("pieces.txt")
    contents.write_text("".join(f"file '{piece.name}'\n" for piece in pieces))
    source = ("-f", "concat", "-safe", "0", "-i", contents.name)
    joined = ("-c", "copy", "-movflags", "+faststart", f"file:{film.absolute()}")
    _ffmpeg("-y", *source, *joined, folder=contents.parent)


def animate(film: Path, picture: Path) -> None:
    """Turn a film into a small animated picture, for pages that show no films."""
    _ffmpeg("-y", "-i", f"file:{film}", *SMALLER, *WEBP, f"file:{picture}")


def count_pictures(film: Path) -> int:
    """Number of pictures in a film; 0 if it cannot be read."""
    try:
        source = ("-i", f"file:{film}", "-map", "0:v:0", "-c", "copy")
        report = _ffmpeg("-progress", "-", *source, "-f", "null", "-")
    except RenderError:
        return 0
    counts = [line for line in report.splitlines() if line.startswith("frame=")]
    return int(counts[-1].removeprefix("frame=")) if counts else 0


def _ffmpeg(*arguments: str, folder: Path | None = None) -> str:
    """Output of ffmpeg; RenderError if it fails, OSError if the disk is full.

    It works in a folder, since lists of files cut the names of theirs at # and ?.
    """
    command = (_executable(), "-v", "error", "-nostdin", *arguments)
    with telling("no ffmpeg", command[0], INSTALL, RenderError):
        done = subprocess.run(
            command, cwd=folder, capture_output=True, text=True, errors="replace"
        )
    if FULL in done.stderr:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    if done.returncode:
        words = done.stderr.strip().splitlines() or [f"exit code {done.returncode}"]
        raise RenderError(f"ffmpeg failed, {words[-1]}", command[0], INSTALL)
    return done.stdout


def _executable() -> str:
    try:
        return str(imageio_ffmpeg.get_ffmpeg_exe())
    except RuntimeError as error:
        raise RenderError("no ffmpeg", "imageio-ffmpeg", INSTALL) from error
