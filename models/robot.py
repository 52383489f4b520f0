"""A robot: an MJCF file and its card, checked against each other.

Shipped robots and a user's own take the same path. Knows names and addresses; the
equations are in `models.equations`, the physics in `sim`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from importlib.resources import files
from pathlib import Path

import mujoco
import numpy as np

from models.card import Card, LegCard
from models.card_file import read_card
from models.errors import ModelError, UnknownRobotError

FOLDER = Path(str(files("models")))
ON_JOINT = (mujoco.mjtTrn.mjTRN_JOINT, mujoco.mjtTrn.mjTRN_JOINTINPARENT)


@dataclass(frozen=True)
class Robot:
    """A legged robot that the testbed can plan for, walk and judge."""

    name: str
    path: Path  # MJCF file
    card_path: Path  # TOML file
    card: Card

    def __str__(self) -> str:
        return self.name

    @property
    def legs(self) -> tuple[int, ...]:
        """Leg numbers in ascending order; arrays per foot are in this order."""
        return tuple(sorted(self.card.legs))

    @property
    def groups(self) -> tuple[str, ...]:
        """Names of the groups; arrays per group are in this order."""
        return tuple(self.card.groups)

    @cached_property
    def group_of_leg(self) -> np.ndarray:
        """Index of each leg's group, shape (F,)."""
        owner = {
            leg: i for i, g in enumerate(self.card.groups.values()) for leg in g.legs
        }
        return np.array([owner[leg] for leg in self.legs])

    @cached_property
    def swing_gain(self) -> np.ndarray:
        """Swing of each leg's joint per angle of its group: signs or gains, (F,)."""
        gains: dict[int, float] = {}
        for group in self.card.groups.values():
            gains |= group.legs
        return np.array([gains[leg] for leg in self.legs])

    @property
    def lift_joints(self) -> tuple[str, ...]:
        """Lift joint of each leg."""
        return tuple(self.card.legs[leg].lift for leg in self.legs)

    @cached_property
    def raise_sign(self) -> np.ndarray:
        """Sign of each leg's lift joint that raises the foot, shape (F,)."""
        return np.array([float(self.card.legs[leg].raise_sign) for leg in self.legs])

    def planted(self, stratum: str) -> np.ndarray:
        """Which feet are in contact on a stratum, shape (F,), bool."""
        return np.array([self.groups[g] in stratum for g in self.group_of_leg])

    def read(self) -> mujoco.MjSpec:
        """A fresh, editable copy of the MJCF file.

        Raises:
            ModelError: If the file is not MJCF.
        """
        try:
            return mujoco.MjSpec.from_file(str(self.path))
        except (ValueError, RuntimeError) as error:
            reason = " ".join(str(error).split())
            raise ModelError(
                f"not a usable MJCF file: {self.path}; {reason}"
            ) from error

    @cached_property
    def model(self) -> mujoco.MjModel:
        """The file compiled as it stands: for kinematics, masses and joint ranges."""
        model = compile_model(self.read(), str(self.path))
        check_parts(model, self.card, self.path)
        return model

    @property
    def root(self) -> str:
        """Name of the body that carries the free joint."""
        return str(self.model.body(root_body(self.model, self.path)).name)

    @cached_property
    def start_qpos(self) -> np.ndarray:
        """Configuration of keyframe `start`, or the initial one, with joints held."""
        key, model = self._start, self.model
        qpos = np.array(model.qpos0 if key is None else model.key_qpos[key])
        for leg in self.card.legs.values():
            for joint, angle in leg.hold.items():
                qpos[model.joint(joint).qposadr] = angle
        return qpos

    @property
    def start_ctrl(self) -> np.ndarray:
        """Commands of keyframe `start`, or none, of the file's own actuators."""
        key, model = self._start, self.model
        return np.array(np.zeros(model.nu) if key is None else model.key_ctrl[key])

    @property
    def _start(self) -> int | None:
        """Index of keyframe `start`, if there is one."""
        names = [self.model.key(i).name for i in range(self.model.nkey)]
        return names.index("start") if "start" in names else None

    @property
    def root_address(self) -> int:
        """Where the free joint's seven numbers begin in qpos."""
        return int(self.model.jnt_qposadr[self.model.body(self.root).jntadr[0]])

    def standing_angle(self, joint: str) -> float:
        """Angle of a hinge in the configuration `start_qpos` [rad]."""
        return float(self.start_qpos[self.model.joint(joint).qposadr[0]])

    @cached_property
    def swing_range(self) -> Mapping[str, tuple[float, float]]:
        """Lowest and highest angle of each group that all its legs reach [rad]."""
        return {name: self._range_of(name) for name in self.groups}

    def span(self, joint: str) -> tuple[float, float]:
        """Lowest and highest angle that a hinge and its servos allow [rad]."""
        model, index = self.model, self.model.joint(joint).id
        spans = [model.jnt_range[index]] if model.jnt_limited[index] else []
        for servo in actuators_of(model, joint):
            gain, bias = model.actuator_gainprm[servo, 0], model.actuator_biasprm[servo]
            if model.actuator_ctrllimited[servo] and bias[1] == -gain:
                gear = model.actuator_gear[servo, 0]
                spans.append(np.sort(model.actuator_ctrlrange[servo] / gear))
        low = max((float(span[0]) for span in spans), default=-np.pi)
        return low, min((float(span[1]) for span in spans), default=np.pi)

    def _range_of(self, group: str) -> tuple[float, float]:
        ends = []
        for leg, gain in self.card.groups[group].legs.items():
            joint = self.card.legs[leg].swing
            start = self.standing_angle(joint)
            ends.append(sorted((end - start) / gain for end in self.span(joint)))
        return max(low for low, _ in ends), min(high for _, high in ends)


def compile_model(spec: mujoco.MjSpec, source: str) -> mujoco.MjModel:
    """Compile, turning every refusal of the compiler into one line.

    Raises:
        ModelError: If the compiler refuses, or a number in the model is not finite.
    """
    try:
        model = spec.compile()
    except (ValueError, RuntimeError, mujoco.FatalError) as error:
        reason = " ".join(str(error).split())
        raise ModelError(f"MJCF does not compile: {source}; {reason}") from error
    for name in ("body_mass", "body_inertia", "body_pos", "geom_size", "geom_friction"):
        if not np.isfinite(getattr(model, name)).all():
            raise ModelError(
                f"{name} is not finite: {source}; the compiler lets it pass"
            )
    return model


def actuator_of(model: mujoco.MjModel, joint: str) -> int:
    """Index of the first actuator that drives a joint.

    Raises:
        ModelError: If there is none.
    """
    found = actuators_of(model, joint)
    if not found:
        raise ModelError(f"no actuator drives joint {joint!r}: give it a servo")
    return found[0]


def actuators_of(model: mujoco.MjModel, joint: str) -> list[int]:
    """Indices of the actuators that drive a joint."""
    on_joints = np.isin(model.actuator_trntype, ON_JOINT)
    same = model.actuator_trnid[:, 0] == model.joint(joint).id
    return [int(i) for i in np.flatnonzero(on_joints & same)]


def robots() -> tuple[str, ...]:
    """Names of the shipped robots."""
    return tuple(sorted(path.stem for path in FOLDER.glob("*.toml")))


def load(name: str) -> Robot:
    """A shipped robot by name, or a user's own by the path of its MJCF file.

    A file without a card beside it is given the card of the shipped robot whose model
    name it carries.

    Raises:
        UnknownRobotError: If there is no such robot or file.
        ModelError: If file or card cannot be used.
    """
    path = Path(name) if name.endswith(".xml") else FOLDER / f"{name}.xml"
    if not name.endswith(".xml") and name not in robots():
        raise UnknownRobotError(
            f"unknown robot: {name!r}; shipped are {', '.join(robots())}, "
            "or give a .xml file"
        )
    if not path.is_file():
        raise UnknownRobotError(
            f"no such robot file: {path}; give the path of an MJCF file"
        )
    card_path = _card_path(path)
    robot = Robot(path.stem, path, card_path, read_card(card_path))
    check_parts(robot.model, robot.card, path)
    return robot


def _card_path(path: Path) -> Path:
    beside = path.with_suffix(".toml")
    if beside.is_file():
        return beside
    try:
        name = mujoco.MjSpec.from_file(str(path)).modelname
    except (ValueError, RuntimeError) as error:
        reason = " ".join(str(error).split())
        raise ModelError(f"not a usable MJCF file: {path}; {reason}") from error
    if name in robots():
        return FOLDER / f"{name}.toml"
    raise ModelError(
        f"no robot card: {beside} is missing; "
        "write one that names legs, groups and gait"
    )


def check_parts(model: mujoco.MjModel, card: Card, path: Path) -> None:
    """Refuse a card that names parts the model does not have.

    Raises:
        ModelError: Naming the missing parts.
    """
    root_body(model, path)
    missing = [
        f"{kind} {name!r}"
        for leg in card.legs.values()
        for kind, name in _parts(leg)
        if name not in _names(model, kind)
    ]
    if missing:
        raise ModelError(
            f"the card names what the model lacks: {path}; {', '.join(missing)}"
        )
    for number, leg in card.legs.items():
        for joint in (leg.swing, leg.lift):
            if model.joint(joint).type != mujoco.mjtJoint.mjJNT_HINGE:
                raise ModelError(
                    f"leg {number}: {path}; joint {joint!r} is not a hinge"
                )


def _parts(leg: LegCard) -> list[tuple[str, str]]:
    joints = [leg.swing, leg.lift, *leg.hold]
    return [("joint", name) for name in joints] + [("geom", name) for name in leg.foot]


def _names(model: mujoco.MjModel, kind: str) -> set[str]:
    count = {"joint": model.njnt, "geom": model.ngeom}[kind]
    return {getattr(model, kind)(i).name for i in range(count)}


def root_body(model: mujoco.MjModel, path: Path) -> int:
    """Index of the body that carries the free joint.

    Raises:
        ModelError: If there is not exactly one free joint.
    """
    free = np.flatnonzero(model.jnt_type == mujoco.mjtJoint.mjJNT_FREE)
    if len(free) != 1:
        raise ModelError(
            f"{len(free)} free joints: {path}; a walking robot has exactly one"
        )
    return int(model.jnt_bodyid[free[0]])
