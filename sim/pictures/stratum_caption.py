"""The present stratum in words: which groups of legs stand, swing, lift or land."""

from __future__ import annotations

from collections.abc import Sequence

from sim.pictures.filmed_walk import FlowRow

NOUNS = {1: "leg", 2: "pair", 3: "tripod", 4: "tetrapod"}  # by legs in a group

Verb = tuple[str, str]  # singular, plural
STANDS: Verb = ("stands", "stand")
WAITS: Verb = ("waits in the air", "wait in the air")
SWINGS_BODY: Verb = ("swings the body", "swing the body")
SWINGS: Verb = ("swings in the air", "swing in the air")
LIFTS: Verb = ("lifts", "lift")
LANDS: Verb = ("lands", "land")


def describe(flow: FlowRow, groups: Sequence[str], legs_per_group: int) -> str:
    """One clause for each group, those that do the same named together.

    Args:
        flow: Flow that is being carried out.
        groups: Names of all groups.
        legs_per_group: Chooses the noun; 0 where the groups differ.

    Returns:
        For example `tripod 1 stands, tripod 2 swings in the air`.
    """
    doing: dict[Verb, list[str]] = {}
    for group in groups:
        doing.setdefault(_verb(flow, group), []).append(group)
    return ", ".join(
        _clause(noun(legs_per_group), names, verb) for verb, names in doing.items()
    )


def noun(legs_per_group: int) -> str:
    """What a group of so many legs is called; 0 where the groups differ."""
    return NOUNS.get(legs_per_group, "group")


def _verb(flow: FlowRow, group: str) -> Verb:
    stands = group in flow.stratum
    if group not in flow.group or flow.kind == "hold":
        return STANDS if stands else WAITS
    if flow.kind == "swing":
        return SWINGS_BODY if stands else SWINGS
    return LIFTS if flow.kind == "lift" else LANDS


def _clause(noun: str, names: list[str], verb: Verb) -> str:
    one, several = verb
    if len(names) == 1:
        return f"{noun} {names[0]} {one}"
    return f"{noun}s {', '.join(names[:-1])} and {names[-1]} {several}"
