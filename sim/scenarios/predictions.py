"""The predictions: their names, what they ignore, and which one walks are judged by.

This is the only place that knows that `quasi_static` is shown as `quasi-static`.
"""

from collections.abc import Collection, Mapping
from typing import NamedTuple

from sim.scenarios.settings import IMPERFECTIONS, SETTINGS, Settings


class PredictionName(NamedTuple):
    """The names that one prediction goes by, and the settings that it knows nothing of.

    What any of its pose, slip and margin ignores counts as ignored.
    """

    key: str  # in summary.json and in the columns of sweeps
    label: str  # for people, and as a value of `steer`
    prefix: str  # of its arrays in trajectory.npz
    ignores: Collection[str] | None = IMPERFECTIONS  # None: all that it is not given

    def array(self, quantity: str) -> str:
        """Name of one of its arrays in trajectory.npz, such as `predicted_pose`."""
        return f"{self.prefix}_{quantity}"

    def ignored(self, scenario: Settings) -> str:
        """What a scenario sets and this prediction ignores, separated by commas."""
        found = imperfect(scenario)
        if self.ignores is None:
            return ", ".join(name for name in found if name not in known_of(scenario))
        return ", ".join(name for name in found if name in self.ignores)


IDEAL = PredictionName("ideal", "ideal", "predicted")
QUASI_STATIC = PredictionName("quasi_static", "quasi-static", "quasi_static")
IDENTIFIED = PredictionName(  # measured in the same world, by plain commands
    "identified",
    "identified",
    "identified",
    ignores=("command_delay", "zero_offset", "payload", "slope", "bumps"),
)
COMPLIANT = PredictionName("compliant", "compliant", "compliant", ignores=None)
PREDICTIONS = {name.key: name for name in (IDEAL, QUASI_STATIC, IDENTIFIED, COMPLIANT)}
COSTLY = (IDENTIFIED.key, COMPLIANT.key, "creep_floor")  # physics of their own
OF_MOTIONS = (QUASI_STATIC.key, COMPLIANT.key)  # that are played and have no fields
LABELS = tuple(name.label for name in PREDICTIONS.values())
JUDGES = (COMPLIANT, QUASI_STATIC, IDEAL)
"""Predictions that walks are judged by, the best first; the first that could be made
is taken. One that costs physics of its own is none of them, as it may be left out."""


def prediction_key(label: str) -> str:
    """Key of the prediction with a label, such as a scenario's `steer`."""
    return next(name.key for name in PREDICTIONS.values() if name.label == label)


def best(made: Collection[str]) -> str:
    """Key of the prediction that a walk is judged by, of those that were made."""
    return next(name.key for name in JUDGES if name.key in made)


def imperfect(scenario: Settings) -> tuple[str, ...]:
    """The imperfections that a scenario sets."""
    values = ((name, getattr(scenario, name)) for name in IMPERFECTIONS)
    return tuple(name for name, value in values if value != SETTINGS[name].default)


def known_of(scenario: Settings) -> tuple[str, ...]:
    """The imperfections that it sets and that the compliant prediction knows.

    What is drawn is not known unless it is asked for; bumps never are.
    """
    hidden: tuple[str, ...] = ("bumps", "imperfect")
    if isinstance(scenario.known, tuple):
        hidden += tuple(n for n in IMPERFECTIONS if n not in scenario.known)
    elif scenario.known == "none":
        hidden = IMPERFECTIONS
    elif scenario.known == "given" and not isinstance(scenario.zero_offset, tuple):
        hidden += ("zero_offset",)
    return tuple(name for name in imperfect(scenario) if name not in hidden)


def who_ignores(ignored: Mapping[str, str]) -> str:
    """Which predictions ignore which settings, by key, in words; empty for none."""
    by: dict[str, list[str]] = {}
    for key, settings in ignored.items():
        by.setdefault(settings, []).append(PREDICTIONS[key].label)
    words = (f"{names} ({', '.join(who)})" for names, who in by.items() if names)
    return "; ".join(words)
