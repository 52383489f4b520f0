"""Likely causes of a walk that went wrong, each with the next step.

Each finder looks for one cause in what was measured and gives a sentence, or nothing.
The first that finds something is believed, so what would spoil any walk comes first.
`causes.toml` has the sentences.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import tan

import numpy as np

from models.description import actuator_of
from planner import Array
from planner.support import sentences
from sim.drive.drive import Drive
from sim.drive.lift_counts import LiftCounts
from sim.evaluation.deviations import Scale, error_sources
from sim.evaluation.motions import Achieved
from sim.evaluation.summary import Weighed
from sim.motion.poses import wrap
from sim.motion.prediction import Prediction
from sim.scenarios import predictions
from sim.walking.finished import Walk
from sim.world.motors import inertia_share

CARRIED = 0.05  # of the time that a foot is to stand; less is as good as nothing
USED_UP = 0.5  # of the friction there is; beyond, feet that slide carry the body along
FULL = 0.01  # of all steps in which a servo may give all it has
LIGHT = 0.2  # of a motor's inertia; joints with less chatter
BENT = 0.03  # [rad] on average, by which a servo lags behind its command
RATTLED = 5  # bounces a touchdown; zeros and backlash of a few degrees make up to 3
HARMLESS = 2  # bounces, of which nothing is said where a walk arrived
say = sentences("sim.evaluation", "causes.toml")


@dataclass(frozen=True)
class Evidence:
    """What is known of a finished walk."""

    walk: Walk
    achieved: Achieved
    predicted: Mapping[str, Prediction]
    weighed: Weighed

    @property
    def best(self) -> Prediction:
        """The prediction that the walk is judged by."""
        return self.predicted[self.weighed.prediction]

    @property
    def walking(self) -> Array:
        """Moments from the start of the walk on, (T,), bool."""
        return self.walk.recording.moments.step >= self.walk.starts

    @property
    def drives(self) -> dict[str, int]:
        """Actuators of the legs, by their joints."""
        model, joints = self.walk.setup.model, self.walk.setup.robot.card.joints
        return {joint: actuator_of(model, joint) for joint in joints}

    @property
    def scale(self) -> Scale:
        """What distances on the walk are weighed by."""
        weighed = self.weighed
        return Scale(weighed.prediction, weighed.radius, weighed.length)

    def on_paper(self, name: str) -> float:
        """How far a prediction ends from the goal, as a share of the path."""
        goal = np.array(self.walk.setup.scenario.path.goal)
        return self.scale.share(self.predicted[name].pose[-1], goal)


def likely_cause(word: str, evidence: Evidence) -> str:
    """The likely cause of what became of a walk, and the next step; may be empty."""
    return next(filter(None, (find(evidence) for find in FINDERS[word])), "")


def _touching(evidence: Evidence) -> str:
    scenario = evidence.walk.setup.scenario
    stood = "obstacles" if scenario.obstacles else "fixed"
    touched = stood if evidence.walk.recording.wall_contacts else "legs"
    return say(touched, twice=2 * scenario.segments)


def _on_paper(evidence: Evidence) -> str:
    """A plan that misses the goal by most of what the walk misses it by."""
    scenario, judge = evidence.walk.setup.scenario, evidence.weighed.prediction
    share = evidence.on_paper(judge)
    if scenario.replan or share <= (evidence.weighed.goal or 0.0) / 2:
        return ""
    facts = {"percent": 100 * share, "label": predictions.PREDICTIONS[judge].label}
    followed = predictions.prediction_key(scenario.steer) == judge
    others = {name.key for name in predictions.JUDGES} & evidence.predicted.keys()
    agree = all(evidence.on_paper(key) <= share / 2 for key in others - {judge})
    if agree and judge == predictions.COMPLIANT.key and not followed:
        names = ", ".join(predictions.known_of(scenario))
        led = Drive(evidence.walk.setup).feeds_forward
        drives = [*evidence.drives.values()]
        softest = evidence.walk.setup.model.actuator_gainprm[drives, 0].min()
        kind = "known" if names else "led" if led else "left"
        return say(f"on_paper_{kind}", names=names, stiffness=softest, **facts)
    groups = evidence.walk.setup.robot.card.groups.values()
    if scenario.fields == "paper" and not any(group.twist for group in groups):
        # a card that gives twists claims them as the paper does
        return say("on_paper_dragging", **facts)
    if followed or evidence.on_paper(predictions.IDEAL.key) > share / 2:
        return say("on_paper_coarse", twice=2 * scenario.segments, **facts)
    return say("on_paper_other", **facts)


def _scaled_down(evidence: Evidence) -> str:
    count, whole = evidence.walk.saturated_segments, evidence.walk.setup.scenario
    facts = {"count": count, "segments": whole.segments, "twice": 2 * whole.segments}
    return say("scaled_down", **facts) if count else ""


def _misled(evidence: Evidence) -> str:
    """Readings that told a robot, as it planned its last segment, of another pose."""
    stops = evidence.walk.followed.stops if evidence.walk.followed else ()
    if not stops[1:]:
        return ""
    thought, true = np.array(stops[-2].thought), np.array(stops[-2].true)
    if evidence.scale.share(thought, true) < (evidence.weighed.goal or 0.0) / 2:
        return ""
    x, y, yaw = thought - true
    return say("misled", off=1e3 * np.hypot(x, y), turned=np.rad2deg(abs(wrap(yaw))))


def _never_loaded(evidence: Evidence) -> str:
    """A foot that was in the air while it was to stand."""
    walking, legs = evidence.walking, evidence.walk.setup.robot.legs
    planned = evidence.best.contact[walking]
    carried = (evidence.achieved.contact[walking] & planned).sum(axis=0)
    share = carried / np.maximum(planned.sum(axis=0), 1)
    worst = int(share.argmin())
    return "" if share[worst] > CARRIED else say("never_loaded", leg=legs[worst])


def _steep(evidence: Evidence) -> str:
    """A floor without friction, or whose slope takes most of what there is."""
    scenario = evidence.walk.setup.scenario
    friction = float(np.mean(scenario.foot_friction or scenario.friction))
    if not friction:
        return say("no_friction")
    if scenario.slope is None:
        return ""
    used = tan(scenario.slope[0]) / friction
    return say("steep", percent=100 * used) if used > USED_UP else ""


def _at_limits(evidence: Evidence) -> str:
    """Servos that gave all their torque."""
    walk, drives = evidence.walk, evidence.drives
    joint = max(drives, key=lambda name: walk.recording.limited[drives[name]])
    share = walk.recording.limited[drives[joint]] / max(walk.steps, 1)
    if share <= FULL:
        return ""
    most = walk.setup.model.actuator_forcerange[drives[joint], 1]
    return say("at_limits", joint=joint, most=most, percent=100 * share)


def _bouncing(evidence: Evidence) -> str:
    """Feet that bounced far more often than they were put down."""
    walk, setup = evidence.walk, evidence.walk.setup
    robot, bounces = setup.robot, walk.recording.bounces_of
    landed = [phase.moving for phase in walk.phases if phase.kind == "land"]
    landings = sum(np.isin(robot.group_of_leg, moving).sum() for moving in landed)
    if bounces.sum() <= RATTLED * landings:
        return ""
    leg = robot.leg_cards[int(bounces.argmax())]
    joints = leg.swing, leg.lift
    often = {"count": bounces.sum(), "names": " and ".join(map(repr, joints))}
    if (share := inertia_share(robot, setup.model, joints)) < LIGHT:
        return say("bouncing_light", percent=100 * share, **often)
    drives = [evidence.drives[joint] for joint in joints]
    stiffness = float(setup.model.actuator_gainprm[drives, 0].max())
    rate, step = setup.servo.rate, 1e3 * setup.limits.timestep
    pace = f"{rate:g} commands a second" if rate else f"a timestep of {step:g} ms"
    return say("bouncing_stiff", stiffness=stiffness, pace=pace, **often)


def _soft(evidence: Evidence) -> str:
    """Servos that bend under their loads."""
    model, walking = evidence.walk.setup.model, evidence.walking
    moments, drives = evidence.walk.recording.moments, list(evidence.drives.values())
    places = [int(model.joint(joint).qposadr[0]) for joint in evidence.drives]
    ctrl = np.concatenate(list(evidence.walk.commands()))[moments.step[walking] - 1]
    bent = np.abs(ctrl[:, drives] - moments.qpos[walking][:, places]).mean(axis=0)
    worst = int(np.argmax(bent))
    if bent[worst] <= BENT:
        return ""
    stiffness = model.actuator_gainprm[drives[worst], 0]
    joint, mean = list(evidence.drives)[worst], 1e3 * bent[worst]
    kind = "led" if Drive(evidence.walk.setup).feeds_forward else "left"
    return say(f"soft_{kind}", joint=joint, stiffness=stiffness, bent=mean)


def _coarse(evidence: Evidence) -> str:
    """Counts with which lift joints cannot follow the loads of their legs."""
    setup = evidence.walk.setup
    if not (resolution := setup.servo.resolution):
        return ""
    counts = LiftCounts(setup.as_planned, feed_forward=True)
    rise = resolution * float(np.abs(setup.kinematics.standing.gives[:, 2]).max())
    facts = {"degrees": np.rad2deg(resolution), "bent": counts.least_bent}
    return "" if counts.fine else say("counts", millimetres=1e3 * rise, **facts)


def _bounced(evidence: Evidence) -> str:
    """Bounces on coarse counts, of a robot that is as planned and arrived."""
    count, scenario = evidence.walk.recording.bounces, evidence.walk.setup.scenario
    why = "" if count <= HARMLESS or scenario.is_imperfect else _coarse(evidence)
    return why and say("bounced", count=count, why=why)


def _hasty(evidence: Evidence) -> str:
    """Strokes that speed up faster than friction holds the feet."""
    setup, scenario = evidence.walk.setup, evidence.walk.setup.scenario
    rates = np.linalg.norm(setup.kinematics.standing.rates, axis=-1)
    gains = setup.robot.largest_gain[setup.robot.group_of_leg]
    speeds_up = scenario.swing_acceleration * float((rates / gains).max())
    held = scenario.friction * float(np.linalg.norm(setup.model.opt.gravity))
    facts = {"speeds_up": speeds_up, "held": held}
    return say("hasty", **facts) if speeds_up > USED_UP * held else ""


def _unknown(evidence: Evidence) -> str:
    """Settings that the prediction, and with it the plan, knows nothing of."""
    scenario, judge = evidence.walk.setup.scenario, evidence.weighed.prediction
    names = predictions.PREDICTIONS[judge].ignored(scenario)
    tried = scenario.replan or scenario.correct > 1 or scenario.motion is not None
    return names and say("still_unknown" if tried else "unknown", names=names)


def _source(evidence: Evidence) -> str:
    """The phases that contributed most, where nothing else is known."""
    walk, weighed = evidence.walk, evidence.weighed
    if walk.setup.scenario.replan:
        return ""
    parts = error_sources(walk, evidence.achieved.pose, evidence.best)
    size = {
        name: float(np.hypot(np.hypot(x, y), weighed.radius * turn))
        for name, (x, y, turn) in parts.items()
    }
    worst = max(size, key=size.__getitem__)
    return say("source", worst=worst) if size[worst] else ""


Finder = Callable[[Evidence], str]
SPOILING: tuple[Finder, ...] = (_steep, _never_loaded, _at_limits, _bouncing)
EXPLAINING: tuple[Finder, ...] = (_hasty, _soft, _unknown, _coarse, _source)
MISSED = (*SPOILING, *EXPLAINING)
FINDERS: Mapping[str, tuple[Finder, ...]] = {
    "fell": (*SPOILING, *EXPLAINING[:-1]),
    "collided": (*SPOILING, _touching),
    "missed": (_steep, _at_limits, _on_paper, _scaled_down, _misled, *MISSED),
    "drifted": MISSED,
    "slipped": MISSED,
    "arrived": (_bounced,),
}  # where to look for causes, by what became of the walk
