"""The text of a drafted card: legs, posture, groups and gait, and what was guessed."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from models.adoption.anatomy import Limb, Pose
from models.adoption.crawl import Crawl
from models.adoption.groups import LEAST_LOAD, Reach, Stand, Swings
from models.adoption.words import guess
from models.description.card import Servo
from models.description.table import toml_key, toml_text
from models.morphology.mjcf import template_of
from planner import Array

NAMES = "123456789"
GAIN = "# leg = angle of its swing joint for each radian of the group"


@dataclass(frozen=True, eq=False)
class GaitDraft:
    """How a robot is to walk."""

    # how far each leg is turned from how it stands, anticlockwise (L,) [rad]
    turns: Array
    lines: tuple[str, ...]  # groups, gait and patterns as the card has them
    guesses: tuple[str, ...]  # a sentence each
    # points that the groups turn the body about, shape (2,) [m]; none in a crawl
    pivots: tuple[Array, ...] = ()
    # swing of each leg's joint per angle of its group, by the place of the leg
    swings: tuple[Swings, ...] = ()


def alternating(
    limbs: Sequence[Limb], pair: Sequence[Stand], reach: Reach | None = None
) -> GaitDraft:
    """Two groups of legs that stand in turn, each turning the body about its pivot."""
    turns = np.zeros(len(limbs))
    lines, guesses, swings = [], [], []
    for name, stand in zip("12", pair, strict=True):
        turns[list(stand.legs)] = stand.turns
        (x, y), most = stand.pivot, np.rad2deg(np.abs(stand.turns).max())
        sense = -1 if y > 0 else 1  # forward for a positive angle
        pairs = zip(stand.legs, stand.gains, strict=True)
        swings.append({i: sense * limbs[i].turn * float(gain) for i, gain in pairs})
        gains = ", ".join(f"{i + 1} = {gain:.9g}" for i, gain in swings[-1].items())
        lines += ["", f"[group.{name}]  # turns the body about ({x:z.4f}, {y:z.4f})"]
        lines.append(f"legs = {{ {gains} }}  {GAIN}")
        if reach is not None and reach.touching:
            lines.append(f"swing = [{-reach.swing:.4g}, {reach.swing:.4g}]")
        legs = " ".join(str(i + 1) for i in stand.legs)
        turned = f"turned by up to {most:.0f} degrees to " if round(most) else ""
        guesses.append(guess("group", x=x, y=y, name=name, legs=legs, turned=turned))
    if reach is not None:
        guesses.append(guess("swings", swing=reach.swing, reason=reach.reason))
    lines += ["", "[gait]", 'strata = ["12", "1", "12", "2", "12"]']
    pivots = tuple(stand.pivot for stand in pair)
    return GaitDraft(turns, tuple(lines), tuple(guesses), pivots, tuple(swings))


def rowing(limbs: Sequence[Limb], crawl: Crawl) -> GaitDraft:
    """A crawl: each leg is a group of its own, and in two patterns all of them row."""
    names = NAMES[: len(limbs)]
    singles = [names.replace(name, "") for name in names]
    strata = [names, *(s for single in singles for s in (single, names))]
    lines = ["", "[group]  # legs = { leg = angle of its swing joint for a radian }"]
    lines += [
        f"{name} = {{ legs = {{ {name} = {limb.turn:g} }} }}"
        for name, limb in zip(names, limbs, strict=True)
    ]
    lines += ["", "[gait]", f"strata = {json.dumps(strata)}"]
    lines.append(f"least_load = {LEAST_LOAD:g}")
    for pattern, gains in (("forward", crawl.forward), ("turn", crawl.turning)):
        swings = (f"{n} = {g:.9g}" for n, g in zip(names, gains, strict=True) if g)
        lines += ["", f"[pattern.{pattern}]", f'strata = ["{names}"]']
        lines.append(f"groups = {{ {', '.join(swings)} }}")
    most = np.rad2deg(np.abs(crawl.turns).max())
    guesses = guess("rows"), guess("strokes", most=most, stroke=crawl.stroke)
    return GaitDraft(crawl.turns, tuple(lines), guesses)


def lift_room(pose: Pose, limbs: Sequence[Limb]) -> float:
    """How far all lift joints can be turned up [rad]."""
    return min(
        max(m.up * (end - pose.angle(m.lift)) for end in pose.span(m.lift))
        for m in limbs
    )


def drafted_lift(pose: Pose, limbs: Sequence[Limb]) -> float:
    """An angle that all lift joints have left for lifting, 0.3 rad if they can."""
    return min(0.3, 0.95 * lift_room(pose, limbs))


def card_text(
    pose: Pose,
    limbs: Sequence[Limb],
    gait: GaitDraft,
    angles: Mapping[str, float],
    servo: Servo | None,
) -> str:
    """Card of a robot that starts at angles [rad]; the servo is for joints without."""
    found = {"pose": pose, "limbs": limbs, "gait": gait, "angles": angles}
    return template_of(Path(__file__).with_name("card.toml.jinja")).render(
        found | {"servo": servo, "key": toml_key, "text": toml_text},
        lift_angle=drafted_lift(pose, limbs),
        lift_time=0.6,  # [s]; faster lifts shake off a foot that bears little
    )
