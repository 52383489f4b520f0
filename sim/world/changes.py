"""What the testbed changes in a robot's file before it walks; see `changes.toml`."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations
from operator import attrgetter

import mujoco
import numpy as np

from models import Robot
from models.description import ON_JOINT
from planner.support import shipped_tables
from sim.scenarios.scenario import Scenario
from sim.world import servos
from sim.world.floor import SOLVING, floor_pairs, scene
from sim.world.motors import added_rotors, undamped_joints
from sim.world.others import couplings, holds_body, loose_joints, other_drives, sprung

LAWS = attrgetter("stiffness", "damping", "range", "frictionloss", "armature")
MESSAGES: Mapping[str, str] = shipped_tables("sim.world", "changes.toml")


def changes(robot: Robot, scenario: Scenario) -> Iterator[str]:
    """One sentence for each change."""
    spec, asked = robot.read(), servos.servo_settings(scenario, robot.card)
    springy, joints = sprung(robot.model), robot.card.joints
    drives = Counter(a.target for a in spec.actuators if a.trntype in ON_JOINT)
    legs = [s for s in servos.position_servos(spec) if s.target in joints]
    none, served = mujoco.mjtDyn.mjDYN_NONE, dict.fromkeys(s.target for s in legs)
    added, feet = added_rotors(robot, asked), [spec.geom(n) for n in robot.card.feet]
    plain = _contact_of(mujoco.MjSpec().worldbody.add_geom())
    pairs, ours = floor_pairs(spec, robot), scene().option
    bound = [robot.model.eq(n).name or f"number {n + 1}" for n in couplings(robot)]
    found: dict[str, Sequence[str]] = {  # names of parts by what is done to them
        "other_drives": other_drives(robot),
        "couplings": bound,
        "options": [n for n in SOLVING if getattr(spec.option, n) != getattr(ours, n)],
        "motors": [j for j in joints if j in drives and j not in served],
        "more": [joint for joint in served if drives[joint] > 1],
        "delayed": [s.target for s in legs if s.delay or s.dyntype != none],
        "offset": [s.target for s in legs if s.biasprm[0]],
        "sprung": [j for j in joints if springy[robot.model.joint(j).id]],
        "rotors": [*added],
        "springs": [*undamped_joints(robot, asked)],
        "wide": [foot.name for foot in feet if foot.margin or foot.gap],
        "soles": [foot.name for foot in feet if _contact_of(foot) != plain],
        "lifted": [body.name for body in spec.bodies if body.gravcomp],
        "moving": [g.name for g in spec.geoms if _moves(g, robot)],
        "ties": [t.name for t in spec.tendons if np.hstack(LAWS(t)).any()],
        "leaning": ["gravity"] if any(spec.option.gravity[:2]) else [],
        "held": [robot.root] if holds_body(robot) else [],
        "loose": loose_joints(robot),
        "pairs": sorted({p.geomname1 for p in pairs} | {p.geomname2 for p in pairs}),
    }
    for what, names in found.items():
        first = ", ".join(map(repr, names[:3])) + (", ..." if names[3:] else "")
        if names:
            inertia = max(added.values(), default=0.0)
            yield MESSAGES[what].format(names=first, inertia=inertia)
    own = sorted({float(foot.friction[0]) for foot in feet} - {scenario.friction, 1.0})
    if own and scenario.foot_friction is None:
        words = ", ".join(f"{mu:g}" for mu in own)
        yield MESSAGES["friction"].format(own=words, friction=scenario.friction)


def _moves(geom: mujoco.MjsGeom, robot: Robot) -> bool:
    """Whether a foot, or a plane that may be the floor, sticks or has a moving skin."""
    stands = geom.name in robot.card.feet or geom.type == mujoco.mjtGeom.mjGEOM_PLANE
    return stands and bool(geom.adhesion or any(geom.surfacevel))


def _contact_of(geom: mujoco.MjsGeom) -> tuple[float, ...]:
    return geom.condim, geom.priority, *geom.solref, *geom.solimp


def overlaps(robot: Robot) -> Iterator[str]:
    """Soles of different legs that are inside one another, contact or not."""
    model = robot.model
    data = mujoco.MjData(model)
    data.qpos[:] = robot.start_qpos
    mujoco.mj_kinematics(model, data)
    soles = [(n, g) for n, leg in robot.card.legs.items() for g in leg.foot]
    for (leg, one), (other, two) in combinations(soles, 2):
        if leg == other:
            continue
        pair = model.geom(one).id, model.geom(two).id
        if (apart := mujoco.mj_geomDistance(model, data, *pair, 0.0, np.zeros(6))) < 0:
            yield MESSAGES["overlap"].format(one=one, two=two, apart=-1e3 * apart)
