"""`stratawalk identify`: a robot's measured fields beside their predictions."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from sim.commands.options import report, robot_of, robot_options, set_option

if TYPE_CHECKING:
    from collections.abc import Mapping

    from models import TwistModel
    from models.motion import MeasuredField
    from sim.preparation.setup import Setup
    from sim.progress import Progress

HELP = "measure a robot's fields by short experiments in the physics"
PLACES = (-1.0, 0.0, 1.0)  # of the span at which twists are shown
OPTIONS = (
    *robot_options("a shipped robot, or a FILE.xml"),
    set_option("any setting of a scenario, such as friction=0.5"),
)


def execute(options: argparse.Namespace) -> None:
    """Measure, and print every field at three places of its swing."""
    from sim.preparation.setup import prepare
    from sim.progress import bar, stage
    from sim.scenarios.file import load_scenario, parse_override

    overrides = dict(parse_override(text) for text in options.set)
    scenario = load_scenario("line", overrides | {"robot": options.robot})
    robot = robot_of(options, scenario.robot)
    with bar(quiet=options.json) as progress:
        with stage(progress, "compiling"):
            setup = prepare(scenario, robot)
        found = fields(setup, progress)
    report(options, found, *map(_describe, found))


def fields(setup: Setup, progress: Progress) -> list[dict[str, Any]]:
    """Every loaded field: measured, quasi-static and ideal twists along its swing.

    A field that could not be measured has nulls, and the reason.
    """
    from sim.experiments.identification import identify
    from sim.experiments.predictions import MODELS, twist_model

    identified = identify(setup, progress)
    others = {name: twist_model(setup, name) for name in MODELS if name != "identified"}
    models = {**others, "identified": identified}
    unmeasured = {"angles": None, "twists": None, "slip": None}
    return [
        {"field": name, "stratum": field.stratum, **_along(field, models)}
        for name, field in identified.fields.items()
    ] + [
        {"field": name, "stratum": field.stratum, **unmeasured, "reason": field.reason}
        for name, field in identified.failed.items()
    ]


def _along(field: MeasuredField, models: Mapping[str, TwistModel]) -> dict[str, Any]:
    """Twists of one field by every model at `PLACES`."""
    import numpy as np

    d = np.array(field.direction)
    ways = field.span * np.array(PLACES)
    swing, rates = ways[:, None] * d, np.tile(d, (len(ways), 1))
    twists = {
        name: model(field.stratum, swing, rates).tolist()
        for name, model in models.items()
    }
    facts = {"angles": ways.tolist(), "twists": twists, "slip": field.slip}
    return facts | {"reason": None}


def _describe(field: dict[str, Any]) -> str:
    place = f"{field['field']} on S{field['stratum']}"
    if field["reason"]:
        return f"{place}: not measured, {field['reason']}\n"
    lines = [
        f"{place}: forward and left [m/rad], yaw [rad/rad]; "
        f"{1e3 * field['slip']:.1f} mm slip in the whole swing"
    ]
    heads = "".join(f"at {angle:+.2f} rad{'':17}" for angle in field["angles"])
    lines.append(f"{'':14}{heads}".rstrip())
    for model, twists in field["twists"].items():
        row = "".join(f"{t[0]:8.4f}{t[1]:9.4f}{t[2]:9.4f}   " for t in twists)
        lines.append(f"{model.replace('_', '-'):14}{row}".rstrip())
    return "\n".join(lines) + "\n"
