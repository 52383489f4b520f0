"""Compilation of MJCF with errors of one line, its checks, and look-ups in the result.

Names and numbers are checked in the text and after compilation: the compiler accepts
most infinite numbers, replaces NaN by defaults, and takes text that is not UTF-8.
"""

import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from models.description.actuators import ON_JOINT
from models.description.table import is_plain
from models.errors import ModelError, message, refusals
from planner import Array

COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)
BAD = re.compile(r"""(?i)\b(\w+)\s*=\s*["'][-+.\de\s]*\b(nan|inf|infinity)\b""")
PARTS = "joint|geom|body|site|mesh|material|texture|hfield|tendon|actuator|link|camera"
TEXTS = re.compile(f"(name|class|file|model|prefix|target|data|({PARTS})[12]?)$")
"""Attributes that may say "nan": they name something."""
QUATERNIONS = {int(mujoco.mjtJoint.mjJNT_FREE): 3, int(mujoco.mjtJoint.mjJNT_BALL): 0}
"""Joints with a quaternion, and where in their coordinates it begins."""
DERIVED = re.compile("0$|^bvh_|^oct_|^geom_aabb|^geom_rbound|mass$|inertia$")
SOLVING = re.compile("iterations$|initpoints$")  # options that a step's time grows with
NOT_XML = re.compile("Problem reading XML file (.*): .* Line number=([0-9]+)")
MOST_ITERATIONS = 1000  # of these; the engine's own are 100 or fewer
WORDS = {"jnt": "joint", "tex": "texture", "cam": "camera", "mat": "material"}

refusal = refusals("models", "refusals.toml")

NANS = list[str]()  # warnings of NaN in the file that is read; others are not kept
mujoco.set_mju_user_warning(lambda text: NANS.extend([text] * ("'NaN'" in text)))


def check_text(path: Path) -> None:
    """Refuse text outside comments that is not in UTF-8, or has a number not finite."""
    text = path.read_bytes().decode(errors="surrogateescape")
    text = COMMENT.sub(lambda comment: "\n" * comment[0].count("\n"), text)
    if odd := re.search("[\udc80-\udcff]", text):  # bytes that are not UTF-8
        byte, line = ord(odd[0]) - 0xDC00, text.count("\n", 0, odd.start()) + 1
        raise refusal("encoding", path, byte=byte, line=line)
    for number in BAD.finditer(text):
        if not TEXTS.search(number[1]):
            line = text.count("\n", 0, number.end()) + 1
            raise refusal("number", path, line=f", line {line}")


def check_model(model: mujoco.MjModel, source: str) -> None:
    """Refuse numbers not finite, endless solvers, and actuators of several controls."""
    for what in _not_finite(model):
        raise refusal("not_finite_compiled", source, what=what)
    for name in filter(SOLVING.search, dir(model.opt)):
        if (count := getattr(model.opt, name)) > MOST_ITERATIONS:
            most = MOST_ITERATIONS
            raise refusal("iterations", source, name=name, count=count, most=most)
    for number in np.flatnonzero(model.actuator_ctrlnum != 1).tolist():
        name, count = model.actuator(number).name, model.actuator_ctrlnum[number]
        raise refusal("controls", source, name=name, count=count)


def _not_finite(model: mujoco.MjModel) -> Iterator[str]:
    for name in _float_arrays():
        array = getattr(model, name)
        if array.size and not np.isfinite(array).all():
            row = int(np.argwhere(~np.isfinite(array))[0, 0])
            yield f"{name} of {_owner(model, name, row)}"
    for section in ("opt", "vis", "stat"):  # beside its arrays
        for name, value in _floats(getattr(model, section)):
            if not np.isfinite(value).all():
                yield f"{section}.{name}"


def check_quaternions(spec: mujoco.MjSpec, model: mujoco.MjModel, source: str) -> None:
    """Refuse keyframes with quaternions of zeros, which the engine takes as upright."""
    for key in spec.keys:
        for joint in (model.joint(i) for i in range(model.njnt)):
            kind = int(joint.type[0])
            if kind not in QUATERNIONS or len(key.qpos) != model.nq:
                continue
            start = int(joint.qposadr[0]) + QUATERNIONS[kind]
            if not any(key.qpos[start + i] for i in range(4)):
                body = f"body {model.body(int(joint.bodyid[0])).name!r}"
                part = f"joint {joint.name!r}" if joint.name else body
                raise refusal("quaternion", source, key=key.name, part=part)


@cache
def _float_arrays() -> tuple[str, ...]:
    """A model's arrays of floats; derived ones last, and of these the body's first."""
    empty = mujoco.MjSpec().compile()
    names = (name for name in dir(empty) if not name.startswith("_"))
    floats = [name for name in names if _is_float(getattr(empty, name))]
    derived = {name for name in floats if DERIVED.search(name)}
    last = {name for name in derived if not name.startswith("body_")}
    return tuple(sorted(floats, key=lambda name: (name in derived, name in last)))


def _is_float(value: object) -> bool:
    return isinstance(value, np.ndarray) and value.dtype.kind == "f"


def _floats(section: object, prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Numbers and arrays of floats in a section, and in the sections inside it."""
    for name in dir(section):
        value = getattr(section, name)
        if name.startswith("_") or callable(value):
            continue
        if isinstance(value, float) or _is_float(value):
            yield prefix + name, value
        elif type(value).__module__.startswith("mujoco"):
            yield from _floats(value, f"{prefix}{name}.")


def _owner(model: mujoco.MjModel, array: str, row: int) -> str:
    """The element that a row of one of the model's arrays belongs to."""
    kind = array.partition("_")[0]
    if kind == "dof":
        kind, row = "jnt", int(model.dof_jntid[row])
    count = getattr(model, f"n{kind}", None)
    word = WORDS.get(kind, kind)
    if count is None or row >= count or not hasattr(model, kind):
        return f"the {word}s"
    name = getattr(model, kind)(row).name
    return f"{word} {name!r}" if name else f"{word} {row}"


def check_name(name: str, source: str) -> None:
    """Refuse a name that cannot stand wherever names are written."""
    if not is_plain(name):
        raise refusal("name", source, name=name)


def compile_model(spec: mujoco.MjSpec, source: str) -> mujoco.MjModel:
    """Compile, refusing what the compiler does, and odd names and numbers."""
    silence_the_engine()
    with (
        one_line(f"{_language(source)} does not compile: {source}"),
        warnings.catch_warnings(action="ignore"),  # hints on style, many lines
    ):
        model = spec.compile()
    model.opt.disableflags = 0  # in which a robot's file has no say
    for name in model.names.split(b"\0"):
        try:
            check_name(name.decode(), source)
        except UnicodeDecodeError as error:
            raise refusal("no_text", source, error=error) from error
    check_model(model, source)
    return model


@contextmanager
def one_line(what: str, *remedy: str) -> Iterator[None]:
    """Turn refusals of the engine into a `ModelError` that gives their reason."""
    try:
        yield
    except (ValueError, RuntimeError, mujoco.FatalError) as error:
        reason = " ".join(str(error).split()).partition(" The static bodies of")[0]
        reason = NOT_XML.sub(r"no XML, line \2 of \1", reason)
        reason = reason.replace(f" of '{what.partition(': ')[2]}'", "")
        if reason.startswith("Could not read '"):
            reason = "there is no XML in it"
        if "must be larger than mjMINVAL" in reason:
            remedy = (message("massless"),)
        if "Error opening file" in reason:
            remedy = ("put it there, or correct meshdir or texturedir",)
        raise ModelError("; ".join((what, reason, *remedy))) from error


def _language(source: str) -> str:
    return "URDF" if source.lower().endswith(".urdf") else "MJCF"


def silence_the_engine() -> None:
    """What the engine warns of is raised as an error; no need to print and log it."""
    log = mujoco.MjLogConfig.get()
    log.logto_file = log.logto_console = False
    log.set()


def read_spec(path: Path) -> mujoco.MjSpec:
    """A fresh, editable copy of an MJCF file."""
    silence_the_engine()
    NANS.clear()
    with one_line(f"not a usable {_language(str(path))} file: {path}"):
        spec = mujoco.MjSpec.from_file(str(path))
    if NANS:  # however they are written
        raise refusal("number", path, line=", or a file that it includes")
    return spec


def named(spec: mujoco.MjSpec) -> None:
    """Name what has no name: parts after body and number, actuators after a joint."""
    kinds = {"body": spec.bodies, "geom": spec.geoms, "actuator": spec.actuators}
    taken = {part.name for parts in kinds.values() for part in parts}
    for kind, parts in kinds.items():
        for number, part in enumerate(parts):
            if not part.name:
                name = f"{kind}_{number}"
                if kind != "actuator":
                    name = f"{part.parent.name or 'robot'}_{name}"
                elif part.trntype in ON_JOINT:
                    name = part.target
                while name in taken:
                    name += "_"
                taken.add(name)
                part.name = name


LEAN = 4e-6  # [rad], far more than is rounded; turns of up to 2e-6 are taken for none


def lean_cylinders(spec: mujoco.MjSpec) -> None:
    """Turn cylinders a little; the engine finds rims of upright ones deep in planes."""
    plain = mujoco.mjtOrientation.mjORIENTATION_QUAT
    for geom in [g for g in spec.geoms if g.type == mujoco.mjtGeom.mjGEOM_CYLINDER]:
        if np.isfinite(along := geom.fromto[3:] - geom.fromto[:3]).all():
            geom.fromto[3 + np.abs(along).argmin()] += LEAN * np.linalg.norm(along)
        if geom.alt.type != plain:
            units = geom.compiler.degree, geom.compiler.eulerseq
            geom.quat, geom.alt.type = spec.resolve_orientation(*units, geom.alt), plain
        w, x, y, z = geom.quat  # where both ends are given it has no effect
        geom.quat = geom.quat + LEAN / 2 * np.array([-x, w, z, -y])


def root_body(model: mujoco.MjModel, path: Path) -> int:
    """Index of the body that carries the free joint; refused if not exactly one."""
    free = np.flatnonzero(model.jnt_type == mujoco.mjtJoint.mjJNT_FREE)
    if len(free) != 1:
        owners = [model.body(int(model.jnt_bodyid[j])).name for j in free]
        of = f", of bodies {', '.join(map(repr, owners))}" if owners else ""
        raise refusal("free_joints", path, count=len(free), of=of)
    return int(model.jnt_bodyid[free[0]])


def fixed_to(model: mujoco.MjModel, root: int) -> Array:
    """Geoms of a body that has joints, and of all that is fixed to it."""
    return np.flatnonzero(model.body_weldid[model.geom_bodyid] == root)


def levelled(model: mujoco.MjModel, root: int, qpos: Array) -> Array:
    """A configuration with its root level and at x = y = yaw = 0, shape (nq,)."""
    level, address = qpos.copy(), int(model.jnt_qposadr[model.body(root).jntadr[0]])
    level[address : address + 2] = 0.0
    level[address + 3 : address + 7] = (1.0, 0.0, 0.0, 0.0)
    return level


def joints_above(model: mujoco.MjModel, body: int) -> list[int]:
    """Joints between a body and the world, from the body upward; free ones left out."""
    found = []
    while body:
        begin, count = model.body_jntadr[body], model.body_jntnum[body]
        found += [int(j) for j in range(begin, begin + count)]
        body = int(model.body_parentid[body])
    return [j for j in found if model.jnt_type[j] != mujoco.mjtJoint.mjJNT_FREE]
