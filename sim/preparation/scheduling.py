"""The flows of a plan as phases of a schedule, and walks that would take too long."""

import os
from collections.abc import Iterable, Sequence
from itertools import groupby
from math import hypot

import numpy as np

from planner import Flow
from planner.systems import gait_steps, merged_segments
from sim.errors import UsageError, message
from sim.motion.schedule import LegState, Schedule, Scheduler
from sim.preparation.setup import Setup
from sim.scenarios.scenario import Scenario
from sim.scenarios.settings import SETTINGS

MOST_STEPS = 1_000_000_000  # of physics: eight hours at 35,000 a second
MOST_TRAVEL = 250_000  # [rad] in so many steps, with the settings of the shipped walks
COPIES = 2  # of each row during evaluation and writing; 1.8 were measured

Move = tuple[int, Flow, tuple[float, ...]]


def schedule_flows(
    setup: Setup, scheduler: Scheduler, segments: Iterable[Iterable[Flow]]
) -> None:
    """Schedule the flows of consecutive segments, and put all feet down at the end.

    The strata of a gait are entered in turn, also those on which nothing flows.
    """
    swings, flows = setup.equations.swings, merged_segments(segments, scheduler.segment)
    moves = [(number, flow, swings[flow.field]) for number, flow in flows]
    if setup.scenario.overlap_recovery:
        moves = overlapped(moves, setup.robot.groups)
    bottom, gait = setup.robot.card.bottom, setup.scenario.gait
    strokes = [flow for _, flow, _ in moves]
    entered: Sequence[tuple[str, ...]] = [*((f.stratum,) for f in strokes), (bottom,)]
    if gait:
        entered = gait_steps(setup.equations.system, strokes, gait, (bottom, bottom))
    *before, after = entered
    for strata, (number, flow, direction) in zip(before, moves, strict=True):
        scheduler.segment = number
        for stratum in strata:
            scheduler.enter(stratum)
        scheduler.flow(flow, direction)
    for stratum in after:
        scheduler.enter(stratum)


def scheduled(
    setup: Setup,
    segments: Iterable[Iterable[Flow]],
    begin: LegState | None = None,
    segment: int = 0,
) -> Schedule:
    """The commands of segments alone, from a state of the legs, by default at rest."""
    scheduler = Scheduler(setup.limits, begin or setup.at_rest, segment=segment)
    schedule_flows(setup, scheduler, segments)
    return scheduler.finish()


def overlapped(moves: Sequence[Move], groups: Sequence[str]) -> list[Move]:
    """The same moves, with legs in the air recovering while others stroke.

    On one stratum each stroke takes along a share of the recoveries that is its own
    share of the strokes. A leg in the air moves no body, so only the time changes.
    """
    stays = groupby(moves, key=lambda move: move[1].stratum)
    return [move for _, stay in stays for move in _shared(list(stay), groups)]


def _shared(stay: list[Move], groups: Sequence[str]) -> list[Move]:
    """The moves of one stay, recoveries shared out among the strokes."""

    def loaded(move: Move) -> bool:
        _, flow, direction = move
        swinging = zip(groups, direction, strict=True)
        return any(share and group in flow.stratum for group, share in swinging)

    strokes = [move for move in stay if loaded(move)]
    recoveries = [move for move in stay if not loaded(move)]
    if not (strokes and recoveries):
        return stay
    ways = np.array([np.multiply(flow.duration, d) for _, flow, d in recoveries])
    lengths = [abs(flow.duration) * max(map(abs, d)) for _, flow, d in strokes]
    shared = []
    for (number, flow, direction), length in zip(strokes, lengths, strict=True):
        along = ways.sum(axis=0) * (length / sum(lengths) / flow.duration)
        shared.append((number, flow, tuple((np.array(direction) + along).tolist())))
    return shared


def check_effort(setup: Setup, steps: int) -> None:
    """Refuse a simulation that takes too many steps or too much memory."""
    scenario = setup.scenario
    needed, there = steps // scenario.sample_every * _row_size(setup), _memory()
    if steps <= MOST_STEPS and needed <= there:
        return
    remedy = _slowest(scenario)
    if steps <= MOST_STEPS:
        remedy = f"raise sample_every above {steps * _row_size(setup) // there}"
    facts = {"needed": needed / 1e9, "there": there / 1e9, "most": MOST_STEPS}
    what = message("effort", steps=steps, every=scenario.sample_every, **facts)
    raise UsageError(what, f"scenario {scenario.name!r}", remedy)


def check_distance(setup: Setup) -> None:
    """Refuse a path that no walk could follow to its end, before planning it."""
    path, twists = setup.scenario.path, [*setup.equations.twists.values()]
    strides, turns = [hypot(*t[:2]) for t in twists], [abs(t[2]) for t in twists]
    ways = (path.length, "m", strides), (abs(path.goal[2]), "rad", turns)
    for way, unit, each in ways:  # of a radian of a stroke
        travel = way / farthest if (farthest := max(each, default=0.0)) else 0.0
        if travel > MOST_TRAVEL:
            where = f"scenario {setup.scenario.name!r}"
            facts = {"way": way, "unit": unit, "travel": travel, "most": MOST_TRAVEL}
            raise UsageError.of("far_goal", where, **facts)


def _row_size(setup: Setup) -> int:
    """Bytes that one row of the trajectory takes until it is written."""
    feet, model = len(setup.robot.legs), setup.model
    achieved, predicted = model.nq + model.nv + 5 * feet + 8, 3 * (2 * feet + 4)
    return int(8 * COPIES * (achieved + predicted))


def _memory() -> int:
    """Half of the machine's memory [bytes]; the rest is left to other programs."""
    return int(os.sysconf("SC_PHYS_PAGES")) * int(os.sysconf("SC_PAGE_SIZE")) // 2


def _slowest(scenario: Scenario) -> str:
    """The setting that lengthens the walk most, compared with its default."""
    powers = {"timestep": 1, "swing_speed": 1, "swing_acceleration": 0.5, "hold": -1}
    longer = {
        name: (SETTINGS[name].default / getattr(scenario, name)) ** power
        for name, power in powers.items()
    }
    name = max(longer, key=longer.__getitem__)
    verb = "lower" if powers[name] < 0 else "raise"
    return f"{verb} {name}, now {getattr(scenario, name):g}"
