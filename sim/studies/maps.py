"""Maps of a sweep: where predictions hold and where robots fall, over two settings."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from planner import Array
from sim.figures.style import STYLE, sheet_of
from sim.folder import whole
from sim.studies.results import CLASSES, LIMITS, Results

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLOURS = ("#009E73", "#56B4E9", "#E69F00", "#D55E00", "#000000", "#BBBBBB")
LEAST = 1e-6  # share of the path; what is smaller is drawn there
MOST = 12  # maps
HIGH = 3.2  # [in]


def draw_maps(results: Results, folder: Path) -> list[Path]:
    """Draw a map of every two settings that vary, or a curve over a single one.

    Args:
        results: Of a sweep.
        folder: Where the pictures go.

    Returns:
        Their files.

    Raises:
        FilesError: If they cannot be written.
    """
    import matplotlib as mpl

    varying = [key for key in results.keys if len(_labels(results.columns[key])) > 1]
    pairs: Sequence[tuple[str, ...]] = list(combinations(varying, 2))[:MOST]
    drawn = []
    with mpl.rc_context(STYLE):
        for keys in pairs or [(key,) for key in varying]:
            figure, axes = sheet_of("a", HIGH)
            (_draw_map if len(keys) == 2 else _draw_curve)(axes["a"], results, *keys)
            _legend(axes["a"], results)
            path = folder / f"{'-'.join(keys)}.png"
            with whole(path) as part:
                figure.savefig(part, metadata={"Software": None})
            drawn.append(path)
    return drawn


def _draw_map(axes: Axes, results: Results, across: str, up: str) -> None:
    """The worst class of the points at each place."""
    x, y = (_place(axes, results, key, way) for key, way in ((across, "x"), (up, "y")))
    worst: dict[tuple[float, float], int] = {}
    for place, found in zip(zip(x, y, strict=True), results.classes, strict=True):
        worst[place] = max(int(found), worst.get(place, 0))
    places = np.array(list(worst))
    size = float(np.clip(9000 / len(worst), 9, 260))
    colours = [COLOURS[found] for found in worst.values()]
    axes.scatter(
        places[:, 0], places[:, 1], s=size, c=colours, marker="s", linewidths=0
    )
    several = len(results) > len(worst)
    note = ", the worst of the points at each place" if several else ""
    axes.set_title(f"off the {_words(results)} prediction{note}")


def _draw_curve(axes: Axes, results: Results, key: str) -> None:
    x = _place(axes, results, key, "x")
    share = np.maximum(np.nan_to_num(results.off, nan=1.0), LEAST)
    colours = [COLOURS[found] for found in results.classes]
    axes.scatter(x, share, s=12, c=colours, linewidths=0)
    axes.set_yscale("log")
    for limit in LIMITS:
        axes.axhline(limit, color="#999999", linewidth=0.6)
    axes.set_ylabel("farthest, as a share of the path")
    axes.set_title(f"off the {_words(results)} prediction")


def _place(axes: Axes, results: Results, key: str, way: str) -> list[float]:
    """Where the points are along an axis, which is named and scaled for its setting."""
    values = results.columns[key]
    getattr(axes, f"set_{way}label")(key)
    if all(type(value) in (int, float) for value in values):
        numbers = np.array(values, dtype=float)
        if numbers.min() > 0 and numbers.max() > 20 * numbers.min():
            getattr(axes, f"set_{way}scale")("log")
        return numbers.tolist()
    labels = _labels(values)
    getattr(axes, f"set_{way}ticks")(range(len(labels)), labels)
    getattr(axes, f"set_{way}lim")(-0.5, len(labels) - 0.5)
    return [float(labels.index(str(value))) for value in values]


def _labels(values: Sequence[Any]) -> list[str]:
    return list(dict.fromkeys(map(str, values)))


def _legend(axes: Axes, results: Results) -> None:
    from matplotlib.lines import Line2D

    counts: Array = np.bincount(results.classes, minlength=len(CLASSES))
    marks = [
        Line2D([], [], color=colour, marker="s", linestyle="", label=f"{name}: {count}")
        for name, colour, count in zip(CLASSES, COLOURS, counts, strict=True)
        if count
    ]
    axes.legend(handles=marks, loc="center left", bbox_to_anchor=(1.0, 0.5))


def _words(results: Results) -> str:
    return results.prediction.replace("_", "-")
