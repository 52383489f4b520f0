"""Plans for walks: of the whole path, or of the next segment.

The scenario names the prediction to steer on. The planner itself uses the ideal one.
"""

from __future__ import annotations

import numpy as np

from models import TwistModel
from planner import Plan
from planner.planning import Step, grid, require_segments
from sim.experiments.predictions import twist_model
from sim.motion.poses import compose, nearest_turn, relative
from sim.planning.aiming import plan_along, segment_ends, steer_along, steer_towards
from sim.planning.counts import angles_after, joined, on_counts
from sim.preparation.setup import Setup


def plan_open_loop(setup: Setup) -> Plan:
    """One plan for the whole path.

    Raises:
        PlannerError: If there is none, or it leaves the joint range.
    """
    _require_segments(setup)
    if setup.servo.resolution:
        return _on_counts(setup)
    twists = _steered_on(setup)
    if twists is None:
        return plan_along(setup, setup.nominal())
    return steer_along(setup, twists)


def plan_segment(
    setup: Setup,
    segment: int,
    pose: np.ndarray,
    swing: tuple[float, ...],
    missing: np.ndarray | None = None,
) -> Step:
    """Plan one segment from the pose reached to its end on the nominal path.

    The predicted end meets the target. The error of the paper's words is not left to
    the next segment, since there may be none.

    Args:
        setup: What to walk.
        segment: Its number, from 0.
        pose: Pose reached, in the start frame, shape (3,).
        swing: Angle of every group [rad].
        missing: By how much it is expected to end off its prediction, seen from where
            it starts, shape (3,); it is aimed as much to the other side.

    Raises:
        PlannerError: If the target cannot be approached from there.
    """
    target = segment_target(setup, segment)
    here = np.array([*pose[:2], nearest_turn(pose[2], to=target[2])])
    if missing is not None:
        target = compose(here, relative(here, target) - missing)
    twists = twist_model(setup, setup.scenario.steered_on)
    step = steer_towards(setup, twists, segment, target, here, swing)
    return on_counts(setup, step, swing)


def _on_counts(setup: Setup) -> Plan:
    """One plan whose strokes end on the servos' counts.

    What rounding adds to each segment or takes away is made good by the next one, which
    is planned from where the quasi-static prediction stands.
    """
    plan_along(setup, setup.nominal())  # refused where the joint range is too short
    twists = twist_model(setup, "quasi_static")
    pose, swing, plans = np.zeros(3), setup.at_rest.swing, list[Plan]()
    for segment in range(setup.scenario.segments):
        plan = plan_segment(setup, segment, pose, swing).plan
        pose = compose(pose, segment_ends(setup, plan, twists, swing)[-1])
        swing = angles_after(setup, plan, swing)
        plans.append(plan)
    return joined(setup, plans)


def segment_target(setup: Setup, segment: int) -> np.ndarray:
    """Pose of the nominal path at the end of a segment, shape (3,).

    Raises:
        PlannerError: If segments cut the path's corners.
    """
    _require_segments(setup)
    nominal = setup.nominal()
    return nominal(grid(nominal, setup.scenario.segments)[segment + 1])[:3]


def _require_segments(setup: Setup) -> None:
    require_segments(setup.scenario.segments, setup.scenario.path.curve)


def _steered_on(setup: Setup) -> TwistModel | None:
    """The prediction to steer on; None where the planner's own is enough.

    Errors of printed words nearly cancel from one segment to the next; those of the
    shortest words add up.
    """
    scenario = setup.scenario
    if scenario.steer == "ideal" and scenario.words == "printed":
        return None
    return twist_model(setup, scenario.steered_on)
