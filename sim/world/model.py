"""The model that a run simulates: a robot on the floor, with the run's settings.

What walking and measurement need is added to the robot's file, also the keyframe
`start`: the pose in which the robot begins, its feet on the floor. Files that it names
are gathered. The robot's own are copied unchanged beside the text, whose numbers MuJoCo
rounds: a rerun from the copies is planned with the same digits.
"""

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np

from models import Kinematics, ModelError, Robot
from models.description import ON_JOINT, compile_model, elements_with_files, one_line
from planner import Array
from planner.support import placed
from sim.errors import message
from sim.scenarios.scenario import Scenario
from sim.world.dead_bands import ensure_dead_bands
from sim.world.floor import SOLVING, Floor, add_bumps, ensure_floor, scene
from sim.world.imperfections import add_imperfections
from sim.world.motors import common_servo, ensure_motors
from sim.world.parts import forget_defaults
from sim.world.sensors import add_walls, ensure_sensors
from sim.world.servos import ensure_servos, servo_settings

START = "start"
SIZES = {mujoco.mjtJoint.mjJNT_FREE: 7, mujoco.mjtJoint.mjJNT_BALL: 4}  # in qpos
MODEL = "model.xml"


@dataclass(frozen=True)
class World:
    """MJCF of robot and world, with the files that it names."""

    text: str
    assets: Mapping[str, bytes]  # by path relative to the text's file
    servo: tuple[float, float] | None  # stiffness and damping, if all joints' are alike
    let_down: float  # how far its robot had to be lowered onto the floor [m]
    floor: str  # geom that its robot stands on

    @property
    def files(self) -> dict[str, bytes]:
        """What to write into a folder, so that bare MuJoCo loads it from there."""
        return {MODEL: self.text.encode(), **self.assets}


def build(robot: Robot, scenario: Scenario) -> World:
    """Robot and world, self-contained."""
    spec, own = robot.read(), scene().option
    forget_defaults(spec)
    for name in ("integrator", "cone", "impratio", "jacobian", *SOLVING):
        setattr(spec.option, name, getattr(own, name))
    spec.option.timestep = scenario.timestep
    servos = servo_settings(scenario, robot.card)
    with _free_names(robot):
        floor = ensure_floor(spec, robot)
        # The engine takes the floor's sliding friction. Nothing sticks, moves, or has a
        # margin: the stiff contact would throw a foot that is yet above the floor.
        for geom in map(spec.geom, (floor.name, *robot.card.feet)):
            geom.friction = (scenario.friction, *geom.friction[1:])
            geom.margin = geom.gap = geom.adhesion = 0.0
            geom.surfacevel = np.zeros(6)
        ensure_servos(spec, robot, servos)
        ensure_motors(spec, robot, servos)
        add_imperfections(spec, robot, floor.name, scenario)
        ensure_sensors(spec, robot, floor.name, uneven=scenario.bumps > 0)
        let_down = ensure_start(spec, robot, floor)
        if scenario.bumps:
            add_bumps(spec, floor, scenario)
        add_walls(spec, robot, floor.name, scenario.obstacles)
        assets = gather(spec, robot)
        model = compile_model(spec, str(robot.path))
        with one_line(f"MuJoCo cannot run the model: {robot.path}"):
            spec.option.integrator = suitable_integrator(model)
        servo = common_servo(model, robot)
        ensure_dead_bands(spec, robot, scenario)
    return World(str(spec.to_xml()), assets, servo, let_down, floor.name)


def load(world: World) -> mujoco.MjModel:
    """Compile the text of a world."""
    with one_line(f"the engine does not read what it wrote: {MODEL}"):
        spec = mujoco.MjSpec.from_string(world.text, assets=dict(world.assets))
    return compile_model(spec, MODEL)


@contextmanager
def _free_names(robot: Robot) -> Iterator[None]:
    """Refuse a robot that has a part with a name that the walk's world gives."""
    try:
        yield
    except (ValueError, ModelError) as error:
        if "repeated name" not in str(error):
            raise
        why = " ".join(str(error).split())
        raise ModelError(message("own_name", path=robot.path, why=why)) from error


def ensure_start(spec: mujoco.MjSpec, robot: Robot, floor: Floor) -> float:
    """Write keyframe `start`: the robot's own, at x = y = yaw = 0, feet on the floor.

    Other keyframes go, since their commands may no longer fit. Returns how far the
    robot was let down onto the floor [m], negative if it was lifted out of it.
    """
    for key in list(spec.keys):
        spec.delete(key)
    spec.nkey = 0  # for which a file may have kept more room
    kinematics, place = Kinematics(robot), 0
    down = float(kinematics.standing.height.min() - floor.height)
    down = down if abs(down) > 1e-7 else 0.0  # [m]; rounding stays
    qpos = kinematics.level_qpos
    qpos[robot.root_address_in(robot.model) + 2] -= down
    own = {robot.model.joint(number).name for number in range(robot.model.njnt)}
    for joint in spec.joints:
        if joint.name not in own:  # it has backlash, from its middle
            qpos = np.insert(qpos, place, 0.0)
        place += SIZES.get(joint.type, 1)
    spec.add_key(name=START, qpos=qpos, ctrl=_ctrl(spec, robot), act=_act(spec, robot))
    return down


def _ctrl(spec: mujoco.MjSpec, robot: Robot) -> list[float]:
    """Leg joints hold their angles; other actuators keep what the robot's file says."""
    own = {robot.model.actuator(i).name: c for i, c in enumerate(robot.start_data.ctrl)}
    return [
        robot.standing_angle(actuator.target)
        if actuator.trntype in ON_JOINT and actuator.target in robot.card.joints
        else own.get(actuator.name, 0.0)
        for actuator in spec.actuators
    ]


def _act(spec: mujoco.MjSpec, robot: Robot) -> list[float]:
    """Activations that the robot's file says; servos of leg joints have none."""
    own, act = robot.model.actuator, robot.start_data.act
    none = mujoco.mjtDyn.mjDYN_NONE
    late = [own(a.name) for a in spec.actuators if a.dyntype != none or a.plugin.active]
    return [float(x) for one in late for x in act[one.actadr[0] :][: one.actnum[0]]]


NUDGE = 1e-6  # [rad] or [m], and as much a second
STABLE = 1.9  # of `explicitness`, whose limit is 2 where the robot starts


def suitable_integrator(model: mujoco.MjModel) -> mujoco.mjtIntegrator:
    """Euler's where it is stable, and the engine's fast implicit one elsewhere.

    That makes standing feet slip in proportion to the timestep, since it allows for
    damping once friction has been solved for.
    """
    kinds = mujoco.mjtIntegrator
    stable = explicitness(model) < STABLE
    return kinds.mjINT_EULER if stable else kinds.mjINT_IMPLICITFAST


def explicitness(model: mujoco.MjModel) -> float:
    """How far a velocity changes in one explicit step, as a multiple of itself.

    With inertia M, stiffness K, damping C and timestep h it is the largest eigenvalue
    of M^-1 (h C + h^2 K / 2). Explicit steps grow from 2 on. The damping of the joints
    themselves is left out, since Euler's integrator treats it implicitly as well.
    """
    h, data = model.opt.timestep, mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    inertia = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, inertia)
    start = data.qpos.copy()

    def forces() -> Array:  # of springs, dampers and servos on every freedom, (nv,)
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fwdVelocity(model, data)
        mujoco.mj_fwdActuation(model, data)
        return data.qfrc_passive + data.qfrc_actuator

    def moved(step: Array) -> Array:
        data.qpos[:] = start
        mujoco.mj_integratePos(model, data.qpos, step, 1.0)
        return forces()

    def moving(velocity: Array) -> Array:
        data.qpos[:], data.qvel[:] = start, velocity
        return forces()

    nudges = NUDGE * np.eye(model.nv)
    stiffness, damping = (  # minus the derivatives of forces, by central differences
        np.stack([after(-s) - after(s) for s in nudges], axis=-1) / (2 * NUDGE)
        for after in (moved, moving)
    )
    damping -= np.diag(model.dof_damping)
    change = np.linalg.solve(inertia, h * damping + h**2 / 2 * stiffness)
    if not np.isfinite(change).all():
        raise ModelError(message("forces"))
    return float(np.linalg.eigvals(change).real.max())


FOLDER = "assets"  # beside model.xml
COPY = "robot"  # folder in the run folder, of the robot's own files


def gather(spec: mujoco.MjSpec, robot: Robot) -> dict[str, bytes]:
    """Make a spec's files those of `assets/`, and return their content.

    It is sorted by path relative to model.xml, with one entry a file, however often the
    file is used.
    """
    named: dict[Path, str] = {}
    for element, folder, found in list(elements_with_files(spec, robot.model)):
        base = Path(spec.modelfiledir) / folder
        if element.file:
            element.file = _rename(named, found or base / element.file)
        for i, file in enumerate(getattr(element, "cubefiles", ())):
            if file:
                element.cubefiles[i] = _rename(named, base / file)
        element.compiler.meshdir = element.compiler.texturedir = ""
    spec.compiler.meshdir = spec.compiler.texturedir = ""
    spec.strippath = False
    content = {name: _read(path, robot) for path, name in named.items()}
    spec.assets = content
    return content


def _rename(named: dict[Path, str], path: Path) -> str:
    """Name of a file in `FOLDER`, its own unless another one has it already."""
    if path not in named:
        name, number = path.name, 1
        while f"{FOLDER}/{name}" in named.values():
            number += 1
            name = f"{path.stem}-{number}{path.suffix}"
        named[path] = f"{FOLDER}/{name}"
    return named[path]


def _read(path: Path, robot: Robot) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        facts = {"why": error.strerror, "path": path, "source": robot.path}
        raise ModelError(message("asset", **facts)) from error


def origin(robot: Robot) -> tuple[str, dict[str, bytes]]:
    """Name or path of the robot in a run folder, and the files that it needs.

    A shipped robot is referred to by its name and needs none. Paths are relative to the
    run folder.
    """
    if robot.is_shipped:
        return robot.name, {}
    mjcf = placed(robot.path)
    used = {placed(path) for path in (mjcf, *robot.opened.files)}
    above = os.path.commonpath([path.parent for path in used])
    copies = {
        Path(COPY, path.relative_to(above)).as_posix(): path.read_bytes()
        for path in sorted(used)
    }
    main = Path(COPY, mjcf.relative_to(above))
    if not robot.has_card_inside:
        copies[main.with_suffix(".toml").as_posix()] = robot.card_text.encode()
    return main.as_posix(), copies
