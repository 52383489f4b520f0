"""Fig. 6: a straight line sideways and forward in ever more segments, and its tube."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from planner.paths import line
from sim.figures.paper import SAMPLES, PaperWalk, configuration, walk
from sim.figures.sheet import Sheet, Table
from sim.figures.style import IDEAL, NOMINAL, WEIGHT, as_map, letter, sheet_of
from sim.figures.tube import exponent, swing_out

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = np.ndarray

SEGMENTS = (1, 4, 16, 60)  # drawn
TUBE_SEGMENTS = (1, 2, 4, 8, 16, 32, 60, 120, 240)  # measured
GOAL = (1.0, 1.0, 0.0)


@dataclass(frozen=True)
class Tube:
    """How a line is followed, by the number of its segments."""

    segments: Array  # (K,)
    width: Array  # largest distance from the line, (K,)
    turn: Array  # largest departure from the line's heading, (K,) [rad]
    error: Array  # distance of the end from the goal, (K,)

    @property
    def length(self) -> Array:
        """Of one segment, (K,)."""
        return np.asarray(np.hypot(*GOAL[:2]) / self.segments)

    @property
    def exponent(self) -> float:
        """Power of the length by which the width grows, over the finer half."""
        fine = self.segments >= np.median(self.segments)
        return exponent(self.length[fine], self.width[fine])


def tube(segments: tuple[int, ...] = TUBE_SEGMENTS) -> Tube:
    """Walk the line in different numbers of segments on the paper's kinematics."""
    walks = [_walk(n, samples=2) for n in segments]
    return Tube(
        segments=np.array(segments),
        width=np.array([_width(walked) for walked in walks]),
        turn=np.array([np.abs(walked.states[:, 2]).max() for walked in walks]),
        error=np.array([walked.error for walked in walks]),
    )


def _walk(segments: int, samples: int = SAMPLES) -> PaperWalk:
    path = line(configuration((0, 0, 0)), configuration(GOAL))
    return walk(path, segments, samples=samples)


def _width(walked: PaperWalk) -> float:
    """Half width of the tube about the line, produced beyond its ends."""
    line_produced = np.outer([-1.0, 2.0], GOAL[:2])
    return float(swing_out(walked.states[:, :2], walked.ends, line_produced).max())


def paper() -> Sheet:
    """From (0, 0, 0) to (1, 1, 0) with l = 1, the numbers of Sec. 6."""
    figure, axes = sheet_of("abe\ncdf", 4.6)
    for name, segments in zip("abcd", SEGMENTS, strict=True):
        _draw_walk(axes[name], _walk(segments))
    measured = tube()
    _draw_tube(axes["e"], measured)
    _draw_errors(axes["f"], measured)
    plural = {n: f"{n} segment{'s' * (n > 1)}" for n in SEGMENTS}
    titles = dict(zip("abcd", plural.values(), strict=True))
    letter(axes, titles | {"e": "tube", "f": "end error"})
    return Sheet(
        name="fig6-line-paper",
        title="Fig. 6, straight line, in the paper's units",
        caption=(
            "Body centre on eqs. (16) to (18), l = 1, from (0, 0, 0) to (1, 1, 0) in "
            "1, 4, 16 and 60 segments; the paper draws four. Dots end segments. Within "
            "a segment the path swings out of the line by the strokes of its bracket: "
            "the tube's half width falls as the square root of the segment's length "
            f"(measured power {measured.exponent:.3f}), while the end error falls as "
            "one over their number. The single segment uses h5 = 5/8, the integral of "
            "the paper's own equation, where the paper prints 3/4."
        ),
        figure=figure,
        table=Table(
            header=(
                "segments",
                "length of one [l]",
                "half width of the tube [l]",
                "largest turn [rad]",
                "end error [l]",
                "end error x segments [l]",
            ),  # fmt: skip
            rows=tuple(
                zip(
                    measured.segments.tolist(),
                    measured.length.tolist(),
                    measured.width.tolist(),
                    measured.turn.tolist(),
                    measured.error.tolist(),
                    (measured.error * measured.segments).tolist(),
                    strict=True,
                )
            ),
        ),
    )


def _draw_walk(axes: Axes, walked: PaperWalk) -> None:
    axes.plot([0, GOAL[0]], [0, GOAL[1]], "--", color=NOMINAL, label="nominal")
    axes.plot(*walked.states[:, :2].T, color=IDEAL, linewidth=0.8, label="walked")
    ends = walked.states[walked.ends, :2]
    axes.plot(*ends.T, "o", color=WEIGHT, markersize=2 if len(ends) < 20 else 1)
    as_map(axes, "$l$")
    axes.legend(loc="lower right")


def _draw_tube(axes: Axes, measured: Tube) -> None:
    axes.loglog(measured.length, measured.width, "o-", color=IDEAL, markersize=3)
    fine = measured.length[[0, -1]]
    through = measured.width[-1] * np.sqrt(fine / fine[-1])
    axes.loglog(fine, through, "--", color=NOMINAL, label="square root")
    axes.set(
        xlabel="length of a segment  [$l$]", ylabel="half width of the tube  [$l$]"
    )
    axes.legend(loc="upper left")


def _draw_errors(axes: Axes, measured: Tube) -> None:
    axes.loglog(measured.segments, measured.error, "o-", color=IDEAL, markersize=3)
    through = measured.error[-1] * measured.segments[-1] / measured.segments
    axes.loglog(measured.segments, through, "--", color=NOMINAL, label="one over n")
    axes.set(xlabel="number of segments n", ylabel="distance from the goal  [$l$]")
    axes.legend(loc="upper right")
