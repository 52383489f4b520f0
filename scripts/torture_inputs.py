"""What `scripts/torture_rows.py` is made of: rows, and the files that they need."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
ROBOTS = ROOT / "models" / "robots"
HEXAPOD, CARD, SCENE = (
    (ROBOTS / name).read_text() for name in ("hexapod.xml", "hexapod.toml", "scene.xml")
)
GO = "--no-video --segments 1 --set path.goal=[0.005,0,0]"
STOP = "timeout --foreground --preserve-status -s"
Make = Callable[[Path], object]


@dataclass(frozen=True)
class Row:
    """One fault: the command, how it must end, and what makes it.

    Attributes:
        number: Rows of one kind have one number.
        fault: In words.
        command: For the shell.
        code: Exit code that it must have.
        test: Of the quick suite; several have blanks between them.
        make: Writes the files that the command needs.
        says: What the line must hold.
        lines: On standard error; one for an error, none otherwise.
    """

    number: int
    fault: str
    command: str
    code: int
    test: str
    make: Make = lambda folder: None
    says: str = ""
    lines: int | None = None

    @property
    def tests(self) -> list[str]:
        """Tests that fail without the guard, `FILE::NAME`."""
        return self.test.split()


def file(name: str, content: str | bytes) -> Make:
    """Make a file; programs may be executed."""
    data = content.encode() if isinstance(content, str) else content

    def make(folder: Path) -> None:
        (folder / name).write_bytes(data)
        if data.startswith(b"#!"):
            (folder / name).chmod(0o755)

    return make


def text_of(name: str, head: str, lines: Iterable[str]) -> Make:
    """Make a long file."""

    def make(folder: Path) -> None:
        with (folder / name).open("w") as file:
            file.write(head)
            file.writelines(lines)

    return make


def link(name: str, target: str) -> Make:
    """Make a link."""
    return lambda folder: (folder / name).symlink_to(target)


def both(*makes: Make) -> Make:
    """Make one thing after another."""
    return lambda folder: [make(folder) for make in makes]


def robot(old: str, new: str) -> Make:
    """Make the shipped hexapod with a text replaced."""

    def make(folder: Path) -> None:
        for name, text in (("xml", HEXAPOD), ("toml", CARD)):
            (folder / f"mine.{name}").write_text(text.replace(old, new))
        (folder / "scene.xml").write_text(SCENE)

    return make


def world(more: str) -> Make:
    """Make the shipped hexapod with something more beside its world."""
    return robot("<keyframe>", f"{more}<keyframe>")


def inside(more: str) -> Make:
    """Make the shipped hexapod with something more on its floor."""
    return robot("<worldbody>", f"<worldbody>{more}")


FAR = 'pos="0 0 9"'
BOMBS = {
    "300,000 copies": (f'<replicate count="300000"><geom size="1" {FAR}/></replicate>'),
    "a fine block": (
        '<flexcomp name="f" type="grid" count="500 500 500" spacing=".1 .1 .1" '
        'dim="3" mass="1"/>'
    ),
    "a fine height field": (
        '<asset><hfield name="h" nrow="40000" ncol="40000" size="1 1 1 1"/></asset>'
    ),
    "a fine texture": (
        '<asset><texture name="t" type="2d" builtin="checker" width="90000" '
        'height="90000"/></asset>'
    ),
    "entities": '<!DOCTYPE m [<!ENTITY a "1"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">]>',
}

NAN_COMMAND = """import sys
import mujoco, numpy as np
from sim.errors import SimulationError, one_line
from sim.physics.engine import Engine
model = mujoco.MjModel.from_xml_string(
    '<mujoco><worldbody><body><joint name="j"/><geom size="1"/></body></worldbody>'
    '<actuator><position name="servo" joint="j"/></actuator>'
    '<keyframe><key name="start"/></keyframe></mujoco>')
try:
    Engine(model).advance(np.array([[0.0], [np.nan]]))
except SimulationError as error:
    print(one_line(error), file=sys.stderr)
    sys.exit(error.exit_code)
"""
FILM = """import resource, threading
from sim import film, load_scenario, simulate
done = simulate(load_scenario("line", {"segments": 1, "path.goal": [0.005, 0, 0]}))
"""
FILM_IN_A_THREAD = (
    FILM
    + """thread = threading.Thread(target=film, args=(done, "a.mp4"))
thread.start()
thread.join()
print(open("a.mp4", "rb").read(8)[4:])
"""
)
MANY_FILMS = (
    FILM
    + """used = []
for i in range(4):
    film(done, f"{i}.mp4")
    used.append(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)
assert used[3] - used[0] < 20, used  # MB; one renderer left open takes 25
print(f"{used[3] - used[0]:.0f} MB more after the fourth film than after the first")
"""
)
FFMPEG_THAT_DIES = """#!/bin/sh
case "$*" in *pipe*|*rawvideo*) head -c 100000 >/dev/null; kill -9 $$;; esac
unset IMAGEIO_FFMPEG_EXE
exec "$(python -c 'import imageio_ffmpeg as f; print(f.get_ffmpeg_exe())')" "$@"
"""


def reordered(folder: Path) -> None:
    """Make the shipped hexapod with its legs in another order."""
    robot("", "")(folder)
    head, *legs = HEXAPOD.split('      <body name="leg_')
    last, end, tail = legs[-1].partition("      </body>\n")
    legs = [*legs[:-1], last + end][::-1]
    text = '      <body name="leg_'.join([head, *legs]) + tail
    (folder / "mine.xml").write_text(text)
