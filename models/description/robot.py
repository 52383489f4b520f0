"""A robot: an MJCF file, its card, and the places of the card's parts in the model."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from importlib.resources import files
from pathlib import Path

import mujoco
import numpy as np

from models.description import compiled
from models.description.actuators import actuators_of, position_servos_of, span_of
from models.description.card import Card, GroupCard, LegCard
from models.description.inspection import Opened

START = ("start", "home")  # names of the keyframe to start from
EMBEDDED = "card"  # name of the custom text that may hold the card
FOLDER = Path(str(files("models.robots")))


@dataclass(frozen=True)
class Robot:
    """A legged robot that the testbed can plan for, walk and judge.

    Example:
        >>> from models import load
        >>> load("hexapod").lift_joints[:2]
        ('lift_1', 'lift_2')
    """

    name: str
    path: Path  # MJCF file
    card_text: str  # TOML
    card: Card
    opened: Opened = Opened()  # files of a user's own
    borrowed: str = ""  # shipped robot whose card it has been given
    geometry: Mapping[str, float] = field(default_factory=dict)  # of a variant
    text: str = ""  # MJCF of a variant, which is in no file

    def __hash__(self) -> int:
        return hash((self.path, self.card_text, self.text))

    @property
    def is_shipped(self) -> bool:
        """Whether it comes with the package, if with other numbers of its shape."""
        return self.path.parent == FOLDER

    @property
    def has_card_inside(self) -> bool:
        """Whether its MJCF file brings its card as custom text."""
        return any(t.name == EMBEDDED for t in compiled.read_spec(self.path).texts)

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
        return np.array(list(self.card.group_of_leg.values()))

    @cached_property
    def swing_gain(self) -> np.ndarray:
        """Swing of each leg's joint per angle of its group: signs or gains, (F,)."""
        groups = list(self.card.groups.values())
        of_leg = self.card.group_of_leg.items()
        return np.array([groups[group].legs[leg] for leg, group in of_leg])

    @cached_property
    def largest_gain(self) -> np.ndarray:
        """Swing of the joint that swings farthest per angle of its group, (G,)."""
        legs = (group.legs.values() for group in self.card.groups.values())
        return np.array([max(map(abs, gains)) for gains in legs])

    @property
    def leg_cards(self) -> tuple[LegCard, ...]:
        """Joints and geoms of each leg, legs in ascending order."""
        return tuple(self.card.legs[leg] for leg in self.legs)

    @property
    def swing_joints(self) -> tuple[str, ...]:
        """Swing joint of each leg."""
        return tuple(leg.swing for leg in self.leg_cards)

    @property
    def lift_joints(self) -> tuple[str, ...]:
        """Lift joint of each leg."""
        return tuple(leg.lift for leg in self.leg_cards)

    @cached_property
    def raise_sign(self) -> np.ndarray:
        """Sign of each leg's lift joint that raises the foot, shape (F,)."""
        return np.array([leg.raise_sign for leg in self.leg_cards], float)

    def leg_angles(self, swing: np.ndarray, lift: np.ndarray) -> dict[str, np.ndarray]:
        """Angle of each joint relative to `standing_angle`, shape (...) [rad].

        Each group has a swing angle and is raised by an angle, shape (..., G) [rad].
        """
        turned, raised = self.joint_angles(swing, lift)
        return {
            joint: angles[..., i]
            for i, leg in enumerate(self.leg_cards)
            for joint, angles in ((leg.swing, turned), (leg.lift, raised))
        }

    def targets(self, swing: np.ndarray, lift: np.ndarray) -> dict[str, np.ndarray]:
        """The angles themselves of these joints, shape (...) [rad]."""
        angles = self.leg_angles(swing, lift)
        return {joint: self.standing_angle(joint) + a for joint, a in angles.items()}

    def joint_angles(
        self, swing: np.ndarray, lift: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """As `leg_angles`: swing and lift joints of all legs, shape (..., F) each."""
        of_leg = self.group_of_leg
        return self.swing_gain * swing[..., of_leg], self.raise_sign * lift[..., of_leg]

    def alternating(self, groups: Mapping[str, Mapping[int, float]]) -> "Robot":
        """The robot with two other groups of legs and gains, which stand in turn.

        Its legs turn no farther than in the groups that they leave.
        """
        first, second = groups
        card = replace(
            self.card,
            groups={g: GroupCard(of, swing=self._room(of)) for g, of in groups.items()},
            gait=(both := first + second, first, both, second, both),
            patterns={},
        )
        return replace(self, card=card)

    def _room(self, legs: Mapping[int, float]) -> tuple[float, float] | None:
        """How far legs of certain gains turn before they may touch others [rad]."""
        ends = [
            sorted(group.legs[leg] / legs[leg] * end for end in group.swing)
            for group in self.card.groups.values()
            for leg in group.legs.keys() & legs.keys()
            if group.swing
        ]
        return (max(e[0] for e in ends), min(e[1] for e in ends)) if ends else None

    def planted(self, stratum: str) -> np.ndarray:
        """Which feet are in contact on a stratum, shape (F,), bool."""
        if stratum not in self._planted:
            feet = np.array([self.groups[g] in stratum for g in self.group_of_leg])
            feet.setflags(write=False)
            self._planted[stratum] = feet
        return self._planted[stratum]

    @cached_property
    def _planted(self) -> dict[str, np.ndarray]:
        return {}

    def read(self) -> mujoco.MjSpec:
        """A fresh, editable copy of the MJCF without a card; every part has a name."""
        if self.text:
            scenes = {path.name: path.read_bytes() for path in FOLDER.glob("*.xml")}
            with compiled.one_line(f"not usable as MJCF: {self.path}"):
                spec = mujoco.MjSpec.from_string(self.text, include=scenes)
        else:
            spec = compiled.read_spec(self.path)
        for text in [text for text in spec.texts if text.name == EMBEDDED]:
            spec.delete(text)
        compiled.named(spec)
        compiled.lean_cylinders(spec)
        return spec

    @cached_property
    def model(self) -> mujoco.MjModel:
        """The file compiled as it stands: for kinematics, masses and joint ranges."""
        return compiled.compile_model(self.read(), str(self.path))

    @cached_property
    def root(self) -> str:
        """Name of the body that carries the free joint."""
        return str(self.model.body(compiled.root_body(self.model, self.path)).name)

    @cached_property
    def start_qpos(self) -> np.ndarray:
        """Configuration in the keyframe to start from, or the file's, joints held."""
        key, model = start_key(self.model), self.model
        qpos = np.array(model.qpos0 if key is None else model.key_qpos[key])
        for angles in (self.card.start, *(leg.hold for leg in self.card.legs.values())):
            for joint, angle in angles.items():
                qpos[model.joint(joint).qposadr] = angle
        return qpos

    @property
    def start_data(self) -> mujoco.MjData:
        """Commands and activations in the keyframe to start from, or none."""
        key, data = start_key(self.model), mujoco.MjData(self.model)
        if key is not None:
            mujoco.mj_resetDataKeyframe(self.model, data, key)
        return data

    def root_address_in(self, model: mujoco.MjModel) -> int:
        """Where the free joint's seven numbers begin in qpos of its file or a world."""
        return int(model.jnt_qposadr[model.body(self.root).jntadr[0]])

    def weight_in(self, model: mujoco.MjModel) -> float:
        """Weight of the robot in a world [N]."""
        gravity = float(np.linalg.norm(model.opt.gravity))
        return gravity * float(model.body_subtreemass[model.body(self.root).id])

    def standing_angle(self, joint: str) -> float:
        """Angle of a hinge in the configuration `start_qpos` [rad]."""
        return float(self.start_qpos[self.model.joint(joint).qposadr[0]])

    @cached_property
    def swing_range(self) -> Mapping[str, tuple[float, float]]:
        """Lowest and highest angle of each group that all its legs reach [rad]."""
        ranges = {}
        for name, group in self.card.groups.items():
            ends = []
            for leg, gain in group.legs.items():
                joint = self.card.legs[leg].swing
                start = self.standing_angle(joint)
                ends.append(sorted((end - start) / gain for end in self.span(joint)))
            if group.swing is not None:
                ends.append(list(group.swing))
            lows, highs = zip(*ends, strict=True)
            ranges[name] = max(lows), min(highs)
        return ranges

    @property
    def joints_without_rotor(self) -> tuple[str, ...]:
        """Leg joints to which neither file nor card gives an armature."""
        return tuple(joint for joint in self.card.joints if not self._armature(joint))

    def _armature(self, joint: str) -> float:
        """Inertia of the rotor behind a joint's gears, of file or card [kg m^2]."""
        model, card = self.model, self.card.servo
        given = card.armature if card and not position_servos_of(model, joint) else 0.0
        given += model.actuator_armature[actuators_of(model, joint)].sum()
        return float(model.dof_armature[model.joint(joint).dofadr[0]] + given)

    def span(self, joint: str) -> tuple[float, float]:
        """Lowest and highest angle that a hinge and its servos allow [rad]."""
        return span_of(self.model, joint, np.pi)


def start_key(model: mujoco.MjModel) -> int | None:
    """Index of the keyframe to start from: the first of `START` that there is."""
    names = [model.key(i).name for i in range(model.nkey)]
    return next((names.index(name) for name in START if name in names), None)
