"""Maps of a sweep: where predictions hold and where robots fall, over two settings.

A page has them in classes that are fitted to the data, with the best and worst walks.
"""

import json
import os
from collections import defaultdict
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, suppress
from itertools import combinations
from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING, cast
from urllib.parse import quote as url
from warnings import catch_warnings, filterwarnings

import numpy as np
from markupsafe import Markup

from planner.support import unfinished
from sim.errors import UsageError
from sim.figures.style import STYLE, plain_decades, sheet_of
from sim.folder import require_free, whole
from sim.palette import FAINT, OUTCOMES, Colour
from sim.reports.drawing import finish
from sim.reports.tables import Table
from sim.scenarios.file import scenario_table, shipped_scenarios, toml_value
from sim.scenarios.settings import FORMER, SETTINGS
from sim.studies.findings import SEPARATE, Findings
from sim.studies.results import LIMITS, NO_WALK, Results
from sim.sweeps.folder import point_in, run_folder
from sim.templates import render

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

UNSHIPPED = "SCENARIO.toml"  # stands for a scenario that is not shipped
SMALLEST_SHARE = 1e-6  # share of the path; what is smaller is drawn there
CELL = 0.92  # of the way from one place to the next
SHAPE = "geometry."
UNITS = {
    "kappa": "", "body_mass": "[kg]", "leg_mass": "[kg]", "swing_range": "[rad]",
    "stiffness": "[N m/rad]", "damping": "[N m s/rad]", "armature": "[kg m²]",
}  # fmt: skip
"""Of the numbers of a robot's shape; the others are lengths."""
SHEET_HEIGHT = 3.2  # [in]
ACROSS, LETTER = 70, 0.08  # letters beside one another; length of one [in]
MOST_LABELS, MOST_MAPS = 200, 12  # at an axis; of a table
MOST_SQUARES = 16  # beside one another, with a number in each that can be read
EXTREMES = 5  # points among the best, and among the worst


def draw_maps(results: Results, folder: Path, new: bool = False) -> list[Path]:
    """Files of the maps of a table, which may have to be new."""
    paths = [folder / f"{'-'.join(keys)}.png" for keys in mapped(results)[:MOST_MAPS]]
    for path in paths * new:
        require_free(path, "--out")
    with ExitStack() as begun:
        for path, (_, figure) in zip(paths, figures(results), strict=True):
            with whole(path, new=new) as part:
                figure.savefig(part, metadata={"Software": None})
            if new:
                begun.enter_context(unfinished(path))
    return paths


def mapped(results: Results) -> Sequence[tuple[str, ...]]:
    """Every two settings that vary, or the only one."""
    varying = [key for key in results.keys if len({*results.columns[key]}) > 1]
    return list(combinations(varying, 2)) or [(key,) for key in varying]


def figures(
    results: Results, fonts: str = "path"
) -> "Iterator[tuple[tuple[str, ...], Figure]]":
    """Settings and maps, or the curve over a single one, for SVG with its fonts."""
    import matplotlib as mpl

    style = {**STYLE, "svg.fonttype": fonts, "text.parse_math": False}  # as in `a$b$`
    with mpl.rc_context(style), catch_warnings():
        filterwarnings("ignore", "Glyph", UserWarning)  # names in any script
        for keys in mapped(results)[:MOST_MAPS]:
            figure, axes = sheet_of("a", SHEET_HEIGHT)
            (_draw_map if len(keys) == 2 else _draw_curve)(axes["a"], results, *keys)
            _legend(axes["a"], results)
            yield keys, figure


def page(results: Results, found: Findings, table: Path, beside: Path) -> str:
    """The page as HTML, which will lie in a folder, with links relative to it."""
    walked = np.flatnonzero(np.isfinite(results.off))
    order = walked[np.argsort(results.off[walked], kind="stable")].tolist()
    few = len(order) <= 2 * EXTREMES
    worst = order[::-1] if few else order[: -EXTREMES - 1 : -1]
    folder = table if table.is_dir() else table.parent
    places = os.path.relpath(folder, beside)
    there = ((c, n) for c, n in found.classes.items() if n)
    counts = [(c, str(n), f"{n / len(results):.0%}") for c, n in there]
    counts += [(f"no walk: {why}", str(n), "") for why, n in found.reasons.items()]
    shares = [
        (key, *("–" if s is None else f"{s:.0%}" for s in (one.departure, one.falls)))
        for key, one in found.ranked
    ]
    drawn = figures(results, "none")
    return render(
        "study.html",
        title=f"{folder.resolve().name}: {str(found).partition(',')[0]}",
        about=f"{', '.join(results.keys)} {'vary' if results.keys[1:] else 'varies'}",
        found=found,
        label=results.label,
        counts=Table(("distance as a share of the path", "points", "share"), counts),
        explained=Table(("explained by", "of distances", "of lost walks"), shares),
        maps=[finish(figure, " and ".join(keys), []) for keys, figure in drawn],
        worst=_points(results, worst, folder, places),
        best=_points(results, [] if few else order[:EXTREMES], folder, places),
    )


def _points(results: Results, points: Sequence[int], folder: Path, base: str) -> Table:
    """Points with their settings, and the report of each or the command that walks."""
    rows, scenario = [], _walked(results)
    for i in points:
        number = int(results.column("point")[i])
        settings = {key: _given(results.columns[key][i]) for key in results.keys}
        own = run_folder(number)
        there = (folder / own / "report.html").exists()
        if there and point_in(folder / own).get("varied") == settings:
            href = f"{url(base)}/{own}/report.html"
            link = Markup('<a href="{}">report</a>').format(href)
        else:
            fixed = {**results.asked.get("set", {}), **settings}
            sets = (f"--set {quote(f'{k}={toml_value(v)}')}" for k, v in fixed.items())
            words = f"stratawalk run {scenario}", *sets
            link = Markup(" ").join(map(Markup("<code>{}</code>").format, words))
        cells = (toml_value(value) for value in settings.values())
        off, word = 100 * results.off[i], results.columns["verdict"][i]
        rows.append((str(number), f"{off:.3g} %", str(word), *cells, link))
    last = "report or command"
    if scenario == UNSHIPPED:
        last += f" ({UNSHIPPED}: asked.scenario of sweep.json)"
    return Table(("point", "farthest off", "verdict", *results.keys, last), rows)


def _given(value: object) -> object:
    """What a point was given: columns of lists, and of unlike values, are JSON."""
    with suppress(ValueError, TypeError, RecursionError):  # of what is no such text
        return json.loads(value)  # type: ignore[arg-type]
    return value


def _walked(results: Results) -> str:
    """A name for the scenario of a sweep; shipped ones may have been changed since."""
    known, table = shipped_scenarios(), results.asked.get("scenario", {})
    name = str(table.get("name"))
    return name if name in known and scenario_table(name)[0] == table else UNSHIPPED


def _draw_map(axes: "Axes", results: Results, across: str, up: str) -> None:
    """The worst of the points at each place: its class, and how far it was off."""
    from matplotlib.patches import Rectangle

    columns = _place(axes, results, across, "x")
    rows = _place(axes, results, up, "y")
    there: dict[tuple[float, float], list[int]] = defaultdict(list)
    for point, place in enumerate(zip(columns, rows, strict=True)):
        there[place].append(point)
    badness = list(zip(results.classes, np.nan_to_num(results.off), strict=True))
    worst = {place: max(some, key=badness.__getitem__) for place, some in there.items()}
    note = ", the worst at each place" if len(results) > len(worst) else ""
    axes.set_title(f"farthest from the {results.label} prediction, % of the path{note}")
    shades = _shades(results)
    colours = {place: shades[results.classes[i]] for place, i in worst.items()}
    named = all(_is_table(results.columns[key]) for key in (across, up))
    if not named or max(len({*columns}), len({*rows})) > MOST_SQUARES:
        size = float(np.clip(9000 / len(worst), 9, 260))
        fills = [colour.hex for colour in colours.values()]
        at, high = zip(*worst, strict=True)
        axes.scatter(at, high, s=size, c=fills, linewidths=0)
        return
    axes.grid(visible=False)
    for (x, y), point in worst.items():  # a square with the share of the path in it
        colour, share = colours[x, y], 100 * results.off[point]
        corner = x - CELL / 2, y - CELL / 2
        axes.add_patch(Rectangle(corner, CELL, CELL, color=colour.hex, linewidth=0))
        texts = [f"{share:#.{digits}g}".rstrip(".") for digits in range(2, 9)]
        read = np.searchsorted(results.limits, [float(text) / 100 for text in texts])
        own = read == np.searchsorted(results.limits, share / 100)
        label = texts[own.argmax()] if np.isfinite(share) else "no walk"  # in its class
        lost = sum(results.classes[one] == NO_WALK for one in there[x, y])
        if 0 < lost < len(there[x, y]):
            label = f"{lost} of {len(there[x, y])}:\n{label}"
        axes.text(x, y, label, color=colour.ink.hex, ha="center", va="center")


def _shades(results: Results) -> list[Colour]:
    """Colours of classes: the hue says how far off, several of one hue darken."""
    hues = np.searchsorted(LIMITS, results.limits).tolist()
    parts = ((hues[:i].count(h) + 2) / (hues.count(h) + 1) for i, h in enumerate(hues))
    shades = map(Colour.tint, map(OUTCOMES.__getitem__, hues), parts)
    return [*shades, *OUTCOMES[len(LIMITS) :]]


def _draw_curve(axes: "Axes", results: Results, key: str) -> None:
    x = _place(axes, results, key, "x")
    share = 100 * np.maximum(np.nan_to_num(results.off, nan=1.0), SMALLEST_SHARE)
    shades = _shades(results)
    colours = [shades[found].hex for found in results.classes]
    axes.scatter(x, share, s=12, c=colours, linewidths=0)
    axes.set_yscale("log")
    plain_decades(axes.yaxis)
    for limit in results.limits:
        axes.axhline(100 * limit, color=FAINT.hex, linewidth=0.6)
    axes.set_ylabel("farthest, % of the path")
    axes.set_title(f"off the {results.label} prediction")


def _place(axes: "Axes", results: Results, key: str, way: str) -> list[float]:
    """Where the points are along an axis, which is named and scaled for its setting."""
    values = results.columns[key]
    getattr(axes, f"set_{way}label")(_named(key))
    if _is_table(values):
        labels = [*(written := _labels(values)).values()]
        if len(labels) > MOST_LABELS:
            facts = {"count": len(labels), "key": key, "most": MOST_LABELS}
            raise UsageError.of("labels", "the table", **facts)
        every = len(labels) // 40 + 1  # which are read beside one another
        ticks = range(0, len(labels), every)
        getattr(axes, f"set_{way}ticks")(ticks, labels[::every])
        getattr(axes, f"set_{way}lim")(-0.5, len(labels) - 0.5)
        longest = max(map(len, labels))
        if way == "x" and longest > min(ACROSS / len(labels), 16):
            axes.tick_params(axis="x", rotation=90)
            cast("Figure", axes.figure).set_figheight(SHEET_HEIGHT + LETTER * longest)
        places = {value: float(place) for place, value in enumerate(written)}
        return [places[value] for value in values]
    numbers = np.array(values, dtype=float)
    if numbers.min() > 0 and numbers.max() > 20 * numbers.min():
        getattr(axes, f"set_{way}scale")("log")
    return numbers.tolist()


def _is_table(values: Sequence[object]) -> bool:
    """Whether values are few, or words, and get places side by side."""
    words = not all(type(value) in (int, float) for value in values)
    return words or len(set(values)) <= SEPARATE


def _named(key: str) -> str:
    """A setting with its unit."""
    if key.startswith(SHAPE):
        return f"{key} {UNITS.get(key.removeprefix(SHAPE), '[m]')}".rstrip()
    declared = SETTINGS.get(FORMER.get(key, key))
    return f"{key} [{declared.unit}]" if declared and declared.unit else key


def _labels(values: Sequence[object]) -> dict[object, str]:
    """Each value as it is written, numbers in order, with digits that tell it apart."""
    numbers = [value for value in values if isinstance(value, int | float)]
    plain = len(numbers) == len(values) and bool not in map(type, values)
    each = [*dict.fromkeys(sorted(numbers) if plain else values)]
    floats, digits = {x for x in each if isinstance(x, float)}, 3
    while digits < 17 and len({f"{x:.{digits}g}" for x in floats}) < len(floats):
        digits += 1
    texts = (f"{x:.{digits}g}" if isinstance(x, float) else str(x) for x in each)
    short = (t if len(t) <= 60 else f"{t[:20]} ... {t[-20:]}" for t in texts)
    return dict(zip(each, short, strict=True))


def _legend(axes: "Axes", results: Results) -> None:
    from matplotlib.lines import Line2D

    classes = zip(results.counts.items(), _shades(results), strict=True)
    marks = [
        Line2D([], [], label=f"{name}: {count}", color=colour.hex, marker="s", ls="")
        for (name, count), colour in classes
        if count
    ]
    axes.figure.legend(handles=marks, title="points", loc="outside right center")
