"""Estimates with their uncertainties: many small least-squares problems side by side.

What is expected of a parameter, its start and spread, enters as one more measurement: a
direction of which the measurements say nothing stays at its start, and is named. It is
unseen where more than half of what was expected is left open.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from planner import Array
from planner.support import shipped_tables

UNSEEN = 0.5  # of the spread of a direction that measurements leave
PART = 0.25  # of a direction, from which on a parameter takes part in it
SETTLED = 0.02  # of standard errors, and of chi square; less ends the search
LENGTHS = np.array([1.0, 0.3, 0.05])  # of a step, of which the best is taken
LEAST_NOISE = 1e-6  # [rad], [m]; no sensor has less, and what is exact can be inverted

Model = Callable[[Array], Array]  # (V, N, P) of variants of parameters (V, P, K)


@dataclass(frozen=True, kw_only=True)
class Parameter:
    """What is estimated, and how far it is expected from where it starts."""

    name: str
    unit: str
    spread: float
    step: float  # of finite differences
    low: float = -np.inf
    logarithm: bool = False  # whether the search, spread and step are about it
    setting: str = ""  # of scenarios, that it is


def parameters_of(what: str) -> tuple[Parameter, ...]:
    """The parameters of a servo or of a body, as `parameters.toml` has them."""
    tables = shipped_tables("sim.fitting", "parameters.toml")[what]
    return tuple(Parameter(name=name, **table) for name, table in tables.items())


@dataclass(frozen=True, eq=False)
class Estimates:
    """Values of K parameters in P problems, and what the measurements say of them."""

    parameters: tuple[Parameter, ...]
    start: Array  # where they were expected, (P, K)
    value: Array  # (P, K)
    information: Array  # of the measurements alone, (P, K, K)
    noise: Array  # standard deviation of what is left over, (P,)
    reach: Array | float = 0.0  # to others that fit as well, (P, K)

    @property
    def spread(self) -> Array:
        """Expected beforehand, (K,)."""
        return np.array([p.spread for p in self.parameters])

    @property
    def expected(self) -> Array:
        """Information of what was expected, (K, K)."""
        return np.diag(1 / self.spread**2)

    @property
    def error(self) -> Array:
        """Standard errors, (P, K)."""
        strength, directions = self._strength
        left = directions**2 / (1 + strength)[:, None]
        return np.hypot(self.spread * np.sqrt(left.sum(axis=-1)), self.reach)

    @cached_property
    def _strength(self) -> tuple[Array, Array]:
        """Of what measurements add to what was expected, in its own directions."""
        scaled = self.information * np.outer(self.spread, self.spread)
        strength, directions = np.linalg.eigh(scaled)
        rounded = np.maximum(strength[:, -1:] * np.finfo(float).eps, -strength[:, :1])
        return strength * (strength > len(self.parameters) * rounded), directions

    @property
    def seen(self) -> Array:
        """Parameters that the measurements determine, (P, K), bool."""
        return self.error < UNSEEN * self.spread

    def of(self, parameter: int, problem: int = 0) -> tuple[float, float]:
        """Value and standard error, of a parameter itself where its logarithm is."""
        value, error = (float(a[problem, parameter]) for a in (self.value, self.error))
        if not self.parameters[parameter].logarithm:
            return value, error
        return float(np.exp(value)), float(np.exp(value) * error)

    @property
    def evidence(self) -> Array:
        """Information times the values of the measurements alone, (P, K)."""
        pulled = (self.value - self.start) / self.spread**2  # by what was expected
        return np.einsum("pkl,pl->pk", self.information, self.value) + pulled

    def unseen(self, problem: int = 0) -> list[str]:
        """In words, what the measurements of a problem do not tell, or not apart."""
        strength, directions = (part[problem] for part in self._strength)
        return [
            _in_words([p.name for p in self.parameters], direction)
            for weight, direction in zip(strength, directions.T, strict=True)
            if 1 / np.sqrt(1 + weight) > UNSEEN
        ]


def _in_words(names: Sequence[str], direction: Array) -> str:
    parts = [i for i in np.argsort(-np.abs(direction)) if abs(direction[i]) > PART]
    if len(parts) == 1:
        return f"{names[parts[0]]} does not show"
    signs = direction * direction[parts[0]]
    words = [f"{'more' if signs[i] > 0 else 'less'} {names[i]}" for i in parts]
    return f"{' with '.join(words)} would look the same"


def solved(
    parameters: Sequence[Parameter],
    start: Array,
    information: Array,
    evidence: Array,
    noise: Array,
) -> Estimates:
    """Estimates from the evidence of measurements, as `Estimates` has it."""
    found = Estimates(tuple(parameters), start, start, information, noise)
    toward = evidence + start / found.spread**2
    value = np.linalg.solve(information + found.expected, toward[..., None])[..., 0]
    return replace(found, value=np.maximum(value, [p.low for p in parameters]))


def estimate(
    model: Model,
    measured: Array,
    parameters: Sequence[Parameter],
    start: Array,
    guess: Array,
    steps: int = 15,
) -> Estimates:
    """Fit P problems by Gauss and Newton's method, each with steps that help it.

    Of what the model predicts, (N, P) was measured, NaN where nothing was. Parameters
    are expected at the start, (P, K); the search begins at a guess, (P, K).
    """
    low = np.array([p.low for p in parameters])
    value = np.maximum(guess, low)
    for _ in range(steps):
        found, toward, weight, left = _around(model, measured, parameters, start, value)
        held = (value <= low) & (toward < 0)  # at a bound, and led beyond it
        way = _newton_step(found.information + found.expected, toward, held)
        if (np.abs(way) < SETTLED * found.error).all():
            break
        tried = np.maximum(value + LENGTHS[:, None, None] * way, low)
        missed = np.where(np.isfinite(measured), measured - model(tried), 0.0)
        cost = _cost(missed, weight, tried - start, found.spread)
        new = tried[cost.argmin(axis=0), np.arange(len(value))]
        before = _cost(left, weight, value - start, found.spread)
        better = cost.min(axis=0) < before - SETTLED
        if not better.any():
            break
        value = np.where(better[:, None], new, value)
    return found


def _around(
    model: Model,
    measured: Array,
    parameters: Sequence[Parameter],
    start: Array,
    value: Array,
) -> tuple[Estimates, Array, Array, Array]:
    """Estimates at a value, and the slope of the likelihood there, (P, K).

    The others are the weight of a row, (P,), and what is left over, (N, P).
    """
    step = np.array([p.step for p in parameters])
    there = np.isfinite(measured)
    count = np.maximum(there.sum(axis=0) - len(parameters), 1)
    variants = np.concatenate([np.zeros((1, len(step))), np.diag(step)])
    predicted = model(value + variants[:, None])
    rise = (predicted[1:] - predicted[0]) / step[:, None, None]
    slope = np.where(there, rise, 0.0)
    left = np.where(there, measured - predicted[0], 0.0)
    noise = np.sqrt((left**2).sum(axis=0) / count)
    weight = 1 / (np.maximum(noise, LEAST_NOISE) ** 2 * _alike(left, there))
    information = np.einsum("knp,lnp,p->pkl", slope, slope, weight)
    found = Estimates(tuple(parameters), start, value, information, noise)
    toward = np.einsum("knp,np,p->pk", slope, left, weight)
    return found, toward - (value - start) / found.spread**2, weight, left


def led(
    model: Model,
    measured: Array,
    parameters: Sequence[Parameter],
    start: Array,
    value: Array,
    shared: Sequence[int],
) -> Estimates:
    """One step of Gauss and Newton from a value, for problems that share parameters.

    It is to be pooled. What is at its least value and would fall below stays there.
    """
    at, toward, *_ = _around(model, measured, parameters, start, value)
    together = toward.copy()
    together[:, shared] = toward[:, shared].sum(axis=0)
    held = (value <= [p.low for p in parameters]) & (together < 0)
    way = _newton_step(at.information + at.expected, toward, held)
    kept = np.where(held[:, :, None] | held[:, None], 0.0, at.information)
    kept += held[:, :, None] * np.eye(len(parameters)) * at.information  # of it alone
    return replace(at, value=value + way, information=kept)


def best_of(found: Sequence[Estimates]) -> Estimates:
    """Of each problem the first estimates, or others that leave over clearly less."""
    noises = np.stack([one.noise for one in found])
    noises[1:] *= 1.02  # which is clearly more
    least = noises.argmin(axis=0), np.arange(noises.shape[1])
    names = "value", "information", "noise"
    best = {name: np.stack([getattr(one, name) for one in found]) for name in names}
    return replace(found[0], **{name: of_all[least] for name, of_all in best.items()})


def _newton_step(matrix: Array, toward: Array, held: Array) -> Array:
    """Solutions (P, K) in which some unknowns are held at zero."""
    free = ~held
    kept = np.where(free[:, :, None] & free[:, None], matrix, np.eye(free.shape[1]))
    wanted = np.where(free, toward, 0.0)[..., None]
    return np.asarray(np.linalg.solve(kept, wanted)[..., 0])


def _cost(left: Array, weight: Array, off: Array, spread: Array) -> Array:
    return weight * (left**2).sum(axis=-2) + (off**2 / spread**2).sum(axis=-1)


def _alike(left: Array, there: Array) -> Array:
    """How many rows say no more than one, (P,).

    A model that is not exact leaves over what changes slowly. For a first-order process
    with a correlation r from row to row, (1 + r) / (1 - r) rows count as one.
    """
    pairs = there[1:] & there[:-1]
    r = np.where(pairs, left[1:] * left[:-1], 0.0).sum(axis=0)
    r = np.minimum(r / np.maximum((left**2).sum(axis=0), LEAST_NOISE**2), 0.999)
    chance = 2 / np.sqrt(np.maximum(pairs.sum(axis=0), 1))
    return np.where(r > chance, (1 + r) / (1 - r), 1.0)


def together(each: Sequence[Estimates]) -> Estimates:
    """The same problems from several sets of measurements, each already fitted."""
    first, *others = each
    if not others:
        return first
    information = sum((e.information for e in others), first.information)
    evidence = sum((e.evidence for e in others), first.evidence)
    noise = np.sqrt(np.mean([e.noise**2 for e in each], axis=0))
    return solved(first.parameters, first.start, information, evidence, noise)


def pooled(
    each: Estimates, shared: Sequence[int], weight: float = 1.0
) -> tuple[Estimates, Estimates]:
    """Parameters that all problems share, from all of them, and each one's others.

    Around its own estimate what a problem's measurements say is taken to be quadratic;
    what they say of shared ones has a weight. The first estimates are of one problem,
    the second of P.
    """
    c = np.array(shared)
    p = np.setdiff1d(np.arange(len(each.parameters)), c)
    H, y, expected = each.information, each.evidence, each.expected[p[:, None], p]
    own, cross = H[:, p[:, None], p] + expected, H[:, c[:, None], p]
    others = y[:, p] + each.start[:, p] / each.spread[p] ** 2
    through = np.swapaxes(np.linalg.solve(own, np.swapaxes(cross, 1, 2)), 1, 2)
    told = H[:, c[:, None], c] - through @ np.swapaxes(cross, 1, 2)
    led_to = y[:, c] - np.einsum("pkl,pl->pk", through, others)
    start, noise = each.start[:, c].mean(axis=0), np.sqrt(np.mean(each.noise**2))
    said = weight * told.sum(axis=0)[None], weight * led_to.sum(axis=0)[None]
    one = solved([each.parameters[k] for k in c], start[None], *said, noise[None])
    rest = others - np.einsum("pkl,k->pl", cross, one.value[0])
    mine = np.linalg.solve(own, rest[..., None])[..., 0]
    whole = np.linalg.inv(one.information[0] + one.expected)
    spread = np.linalg.inv(own) + np.swapaxes(through, 1, 2) @ whole @ through
    parameters = tuple(each.parameters[k] for k in p)
    value = np.maximum(mine, [parameter.low for parameter in parameters])
    information = np.linalg.inv(spread) - expected
    return one, Estimates(parameters, each.start[:, p], value, information, each.noise)
