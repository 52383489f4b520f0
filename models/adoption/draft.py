"""The draft of a card, together with the guesses that it rests on."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np

from models.adoption import anatomy
from models.adoption.card_text import (
    GaitDraft,
    alternating,
    card_text,
    drafted_lift,
    lift_room,
    rowing,
)
from models.adoption.crawl import Crawl, find_crawl
from models.adoption.groups import LEAST_SWING, Stand, free_reach, posed, two_groups
from models.adoption.source import Source
from models.adoption.words import guess, refusal
from models.checks import check_places
from models.description.card_file import parse_card
from models.description.compiled import compile_model, named, root_body
from models.description.robot import Robot, start_key
from models.errors import ModelError
from models.motion.robot_equations import equations, mobility_of
from planner import PlannerError
from planner.support import limited

SHORT = 0.05  # of the longest leg as seen from above: shorter ones push nothing
DEEPEST = np.arctan(2.0)  # of feet; at 3.5 in place of 2 they jam, at 1.7 they do not
SOFT_SHARE = 0.05  # of the stiffness with which a servo sags little
LEVELLED, LEVELLING_STEPS = 1e-5, 4  # [m] between feet, and steps to less than that


@dataclass(frozen=True)
class Draft:
    """A card and the reasons for what it says.

    Attributes:
        card: Text of the card, TOML.
        guesses: What was guessed, one line each.
        limbs: Legs in the order of their numbers, where the robot starts.
        gait: How it is to walk.

    Example:
        >>> from models import draft_card, load, source_of
        >>> draft = draft_card(source_of(str(load("hexapod").path)))
        >>> draft.card.splitlines()[1]
        'lift_angle = 0.3'
    """

    card: str
    guesses: tuple[str, ...]
    limbs: tuple[anatomy.Limb, ...]
    gait: GaitDraft


def draft_card(source: Source) -> Draft:
    """Draft a card for a robot.

    Args:
        source: Its file.

    Raises:
        ModelError: The robot has no legs that this project can move, no groups that
            stand, or no posture to stand in; the message says which.

    Example:
        >>> from models import draft_card, load, source_of
        >>> len(draft_card(source_of(str(load("hexapod").path))).limbs)
        6
    """
    spec, name = source.spec(), str(source.given)
    named(spec)
    model = compile_model(spec, name)
    check_places(model, name)
    key = start_key(model)
    start = model.qpos0 if key is None else model.key_qpos[key]
    pose = anatomy.Pose.at(model, root_body(model, source.given), start)
    angles, turned = _posture(pose, name)
    limbs = _numbered(anatomy.find_limbs(pose, name))
    way = _gait(pose, limbs, name)
    gait = rowing(limbs, way) if isinstance(way, Crawl) else alternating(limbs, way)
    for limb, turn in zip(limbs, gait.turns, strict=True):
        angles[limb.swing] = pose.angle(limb.swing) + limb.turn * float(turn)
    pose.turn(angles)
    angles |= _level(pose, limbs)  # which legs on axes that lean are no more
    if not isinstance(way, Crawl):
        reach = free_reach(pose, limbs, gait.swings, drafted_lift(pose, limbs), name)
        gait = alternating(limbs, way, reach)
    joints = [joint for limb in limbs for joint in limb.joints]
    arm = max(float(np.linalg.norm(limb.toe[:2] - limb.hip)) for limb in limbs)
    suited = anatomy.drafted_servo(pose, joints, arm, len(limbs))
    found = {joint: anatomy.servo_stiffness(model, joint) for joint in joints}
    servo = None if all(found.values()) else suited
    rest = sum(len(limb.hold) for limb in limbs)
    held = f"; {rest} more are held" if rest else ""
    guesses = [*source.notes, *turned, guess("legs", count=len(limbs), held=held)]
    guesses += gait.guesses
    if servo is not None:
        guesses.append(guess("servos", servo=servo))
    if soft := [j for j in joints if 0 < found[j] < SOFT_SHARE * suited.stiffness]:
        wanted, damping = float(f"{suited.stiffness:.3g}"), suited.damping
        about = {"joint": soft[0], "stiffness": found[soft[0]], "suited": wanted}
        guesses.append(guess("soft", count=len(soft), damping=damping, **about))
    turn, joint = max((np.ptp(pose.span(joint)), joint) for joint in joints)
    if turn > 4 * np.pi:  # from end to end of its limits
        guesses.append(guess("wide", joint=joint, turn=np.rad2deg(turn)))
    if lift_room(pose, limbs) <= 0:
        low = min(limbs, key=lambda limb: lift_room(pose, [limb])).lift
        raise refusal("at_the_end", name, joint=low)
    card = card_text(pose, limbs, gait, angles, servo)
    return Draft(card, tuple(guesses), limbs, gait)


def _posture(pose: anatomy.Pose, file: str) -> tuple[dict[str, float], list[str]]:
    """Turn joints of a pose that does not stand; their angles [rad], and why."""
    notes, limbs = [], anatomy.find_limbs(pose, file)
    if angles := _mid_range(pose, limbs):
        pose.turn(angles)
        limbs = anatomy.find_limbs(pose, file)
        notes.append(guess("middle", joint=min(angles), more=len(angles) - 1))
    if not anatomy.stands(pose, limbs):
        angles |= anatomy.standing_angles(pose, limbs, file)
        pose.turn(angles)
        notes.append(guess("bent"))
    if _depth(pose, limbs) > DEEPEST:
        angles |= (spread := _spread(pose, limbs))
        notes.append(guess("spread" if spread else "jammed"))
    return angles | _level(pose, limbs), notes


def _mid_range(pose: anatomy.Pose, limbs: Sequence[anatomy.Limb]) -> dict[str, float]:
    """The middle of its range, for each swing joint at or beyond an end [rad]."""
    limited = pose.model.jnt_limited
    joints = [m.swing for m in limbs if limited[pose.model.joint(m.swing).id]]
    spans = {joint: (*pose.span(joint), pose.angle(joint)) for joint in joints}
    return {
        joint: (low + high) / 2
        for joint, (low, high, angle) in spans.items()
        if min(angle - low, high - angle) < LEAST_SWING
    }


def _depth(pose: anatomy.Pose, limbs: Sequence[anatomy.Limb]) -> float:
    """Angle at which the steepest leg goes down from lift joint to foot [rad]."""
    feet = [pose.bottom(pose.model.geom(limb.foot).id) for limb in limbs]
    x, y, z = np.subtract(feet, [pose.data.joint(m.lift).xanchor for m in limbs]).T
    return float(np.arctan2(-z, np.hypot(x, y)).max())


def _spread(pose: anatomy.Pose, limbs: Sequence[anatomy.Limb]) -> dict[str, float]:
    """Angles of lift joints, all turned up alike, for feet not too far below them.

    The pose is moved; it stays where there are no such angles.
    """
    begin = {limb.lift: pose.angle(limb.lift) for limb in limbs}
    for turn in np.arange(0.0, lift_room(pose, limbs) / 2, np.deg2rad(1)):
        angles = {m.lift: begin[m.lift] + m.up * float(turn) for m in limbs}
        pose.turn(angles)
        if _depth(pose, limbs) <= DEEPEST and anatomy.stands(pose, limbs):
            return angles
    pose.turn(begin)
    return {}


def _level(pose: anatomy.Pose, limbs: Sequence[anatomy.Limb]) -> dict[str, float]:
    """Angles of lift joints that put feet which `stands` accepts on one floor.

    The pose is moved; legs that are stiff do not bend by what drawings are off.
    """
    feet = {limb.lift: pose.model.geom(limb.foot).id for limb in limbs}
    heights = [pose.bottom(foot)[2] for foot in feet.values()]
    if np.ptp(heights) <= LEVELLED:
        return {}
    for _ in range(LEVELLING_STEPS):
        for lift, foot in feet.items():
            arm = pose.bottom(foot) - pose.data.joint(lift).xanchor
            rise = np.cross(pose.data.joint(lift).xaxis, arm)[2]
            off = np.mean(heights) - pose.bottom(foot)[2]
            pose.turn({lift: pose.angle(lift) + float(off / rise)})
    return {lift: pose.angle(lift) for lift in feet}


def _gait(
    pose: anatomy.Pose, limbs: Sequence[anatomy.Limb], file: str
) -> tuple[Stand, Stand] | Crawl:
    """Two groups that stand in turn; a crawl where there are none."""
    arms = np.linalg.norm([limb.toe[:2] - limb.hip for limb in limbs], axis=1)
    if arms.min() < SHORT * max(float(arms.max()), 1e-9):
        raise refusal("below", file, foot=limbs[int(arms.argmin())].foot)
    weight = pose.center_of_mass[:2]
    # how far each leg may turn clockwise and anticlockwise from where it is [rad]
    spans = [np.array(pose.span(m.swing)) - pose.angle(m.swing) for m in limbs]
    turns = [limb.turn * span for limb, span in zip(limbs, spans, strict=True)]
    room = np.sort(turns, axis=1)
    try:
        ways = two_groups(limbs, weight, file)
    except ModelError as alone:
        try:
            return find_crawl(pose, limbs, room, file)
        except ModelError as either:
            why = str(alone).partition(": ")[0]
            raise ModelError(f"{why}, and {either}") from alone
    return posed(limbs, ways, weight, room, file)


def _numbered(limbs: Sequence[anatomy.Limb]) -> tuple[anatomy.Limb, ...]:
    """Pairs from front to back, odd numbers left; around the body if not in pairs."""
    middle = np.mean([limb.toe[:2] for limb in limbs], axis=0)
    back = sorted(limbs, key=lambda limb: -limb.toe[0])
    left = [limb for limb in back if limb.toe[1] > middle[1]]
    right = [limb for limb in back if limb.toe[1] <= middle[1]]
    if len(left) == len(right):
        return tuple(chain.from_iterable(zip(left, right, strict=True)))
    bearings = [np.arctan2(*(limb.toe[:2] - middle)[::-1]) for limb in limbs]
    order = np.argsort(np.mod(bearings, 2 * np.pi), kind="stable")
    return tuple(limbs[i] for i in order)


PROPOSING = 20.0  # [s] for a proposal, which takes 3 s for twelve legs
UNITS = {"x": "metre forward", "y": "metre sideways", "theta": "radian of yaw"}


def propose(robot: Robot) -> str:
    """What strokes cost with the groups and posture of `draft_card`, in words.

    Empty where the robot could not go everywhere with them either, or where they are
    not found in time, as among the groups of forty legs.
    """
    try:
        with limited(PROPOSING):
            draft = draft_card(Source(robot.path, robot.path, None))
        card = parse_card(draft.card, "draft")
        posed = replace(robot, card_text=draft.card, card=card)
        found = mobility_of(posed, equations(posed))
    except (ModelError, PlannerError):
        return ""
    if found.lacking:
        return ""
    turned = np.rad2deg(np.abs(draft.gait.turns).max())
    costs = ", ".join(
        f"{cost.strokes:,.0f} strokes a {UNITS[cost.direction]}" for cost in found.costs
    )
    return f"with its legs turned by up to {turned:.0f} degrees it would take {costs}"
