"""A trial compilation of a user's model, in a process with limited time and memory.

`description.inspection` runs this module as a program, with the MJCF file and the
limits as arguments; the last line of its output is JSON.
"""

from __future__ import annotations

import json
import resource
import sys
from pathlib import Path

import mujoco

from models.description.compiled import compile_model, one_line, read_spec
from models.description.inspection import assets, included
from models.description.numbers import check_quaternions, check_text
from models.errors import ModelError

HANDY = 5 * 10**8  # bytes of a compiled model
TOO_LARGE = ("Could not allocate memory", "unknown exception")  # as MuJoCo says it


def examine(path: Path) -> list[Path]:
    """The files that a model opens, itself included, once it has been compiled."""
    texts = included(path)
    for text in texts:
        if text.read_bytes()[:100].lstrip(b"\xef\xbb\xbf\r\n\t ").startswith(b"<"):
            check_text(text)
    model = compile_model(read_spec(path), str(path))
    _require_handy(model, path)
    with one_line(f"the engine cannot run it: {path}", "is <size memory> too small?"):
        data = mujoco.MjData(model)
        for key in [*range(model.nkey), -1]:  # -1: as the file has it
            mujoco.mj_resetDataKeyframe(model, data, key)
            mujoco.mj_step(model, data)
    spec = read_spec(path)
    check_quaternions(spec, model, str(path))
    named = assets(spec, model)  # compiling may drop some from a spec
    for file in sorted(named):
        if not file.is_file():
            raise ModelError(
                f"a file is missing: {file}, which {path} names; put it there, or "
                "correct meshdir or texturedir"
            )
    return sorted({path, *texts, *named})


def _require_handy(model: mujoco.MjModel, path: Path) -> None:
    """Refuse a model of which there is no room for the copies that a walk needs."""
    numbers = model.nsensordata + model.nuserdata + model.nq + model.nv
    size = mujoco.mj_sizeModel(model) + 8 * numbers
    if size > HANDY:
        raise ModelError(
            f"too large: {path}; compiled it has {size / 1e9:.1f} GB, and "
            f"{HANDY / 1e9:g} GB are the most, leave parts out"
        )


def report(path: Path) -> dict[str, object]:
    """The `files` of a usable model, what is `wrong` with it, or that it is `large`."""
    try:
        return {"files": [str(file) for file in examine(path)]}
    except ModelError as error:
        large = any(sign in str(error) for sign in TOO_LARGE)
        return {"large": True} if large else {"wrong": str(error)}
    except MemoryError:
        return {"large": True}


def main(path: str, seconds: str, memory: str) -> None:
    """Try a model within limits of time [s] and memory [bytes]; print the report."""
    resource.setrlimit(resource.RLIMIT_CPU, (int(seconds), int(seconds)))
    resource.setrlimit(resource.RLIMIT_AS, (int(memory), int(memory)))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    print("", json.dumps(report(Path(path))), sep="\n", flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
