"""`stratawalk identify`: a robot's fields as measured, beside what predicts them."""

from __future__ import annotations

import argparse
import json
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sim.setup import Setup

HELP = "measure a robot's fields by short experiments in the physics"
PLACES = (-1.0, 0.0, 1.0)  # of the span at which twists are shown


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    parser.add_argument("robot", metavar="ROBOT", help="a shipped robot, or a FILE.xml")
    parser.add_argument(
        "--set",
        metavar="KEY=VALUE",
        action="append",
        default=[],
        help="any setting of a scenario, such as friction=0.5; may be repeated",
    )


def execute(options: argparse.Namespace) -> None:
    """Measure, and print every field at three places of its swing."""
    from sim.scenario_file import load, parse_override
    from sim.setup import prepare

    overrides = dict(parse_override(text) for text in options.set)
    setup = prepare(load("line", overrides | {"robot": options.robot}))
    found = fields(setup)
    if options.json:
        print(json.dumps(found, indent=1))
        return
    for field in found:
        print(_describe(field))


def fields(setup: Setup) -> list[dict[str, Any]]:
    """Every loaded field: measured, quasi-static and ideal twists along its swing."""
    import numpy as np

    from models.identified import IdentifiedTwists
    from sim.twist_models import MODELS, twist_model

    identified = twist_model(setup, "identified")
    if not isinstance(identified, IdentifiedTwists):
        raise TypeError(f"identified twists are {type(identified).__name__}")
    found = []
    for name, field in identified.fields.items():
        d = np.array(field.direction)
        ways = field.span * np.array(PLACES)
        swing, rates = ways[:, None] * d, np.tile(d, (len(ways), 1))
        twists = {
            model: twist_model(setup, model)(field.stratum, swing, rates).tolist()
            for model in MODELS
        }
        found.append(
            {
                "field": name,
                "stratum": field.stratum,
                "angles": ways.tolist(),
                "twists": twists,
                "slip": field.slip,
            }
        )
    return found


def _describe(field: dict[str, Any]) -> str:
    lines = [
        f"{field['field']} on S{field['stratum']}: forward and left [m/rad], yaw "
        f"[rad/rad]; {1e3 * field['slip']:.1f} mm slip in the whole swing"
    ]
    lines.append(
        f"{'':14}" + "".join(f"at {a:+.2f} rad{'':17}" for a in field["angles"])
    )
    for model, twists in field["twists"].items():
        row = "".join(f"{t[0]:8.4f}{t[1]:9.4f}{t[2]:9.4f}   " for t in twists)
        lines.append(f"{model.replace('_', '-'):14}{row}".rstrip())
    return "\n".join(lines) + "\n"
