"""Scenarios as TOML files: reading them by name or path, and writing them whole."""

from collections.abc import Collection, Iterable, Mapping
from copy import deepcopy
from functools import cache
from importlib.resources import files
from pathlib import Path
from shlex import quote
from typing import Any

from models.description import parse_toml, toml_key, toml_text
from planner.support import did_you_mean, placed, read_text
from sim.endings import command
from sim.errors import UsageError, printable, telling
from sim.progress import say
from sim.scenarios import body_path as nominal, obstacles as shapes
from sim.scenarios.body_path import START
from sim.scenarios.declaration import Table
from sim.scenarios.scenario import Scenario
from sim.scenarios.settings import FORMER, SETTINGS

Values = dict[str, Any]  # a table of plain values, by key
KEYS = (*SETTINGS, "path", "obstacles")
CALLED = {"mu": "friction", "goal": "path", "speed": "swing_speed"}  # other words
TABLES = {name for name, item in SETTINGS.items() if item.includes(Mapping)}
FOLDER = Path(str(files("sim.scenarios")))


def shipped_scenarios() -> tuple[str, ...]:
    """Names of the scenarios that come with the package.

    Example:
        >>> from sim import shipped_scenarios
        >>> shipped_scenarios()
        ('corridor', 'detour', 'diagonal', 'ellipse', 'line')
    """
    return tuple(sorted(path.stem for path in FOLDER.glob("*.toml")))


def load_scenario(
    source: Path | str, overrides: Mapping[str, object] | None = None
) -> Scenario:
    """Read a scenario.

    Args:
        source: Name of a shipped scenario, or path of a TOML file.
        overrides: Values that replace the file's; `path.goal` reaches into its table.

    Raises:
        UsageError: If there is no such file, it is not TOML, a key is unknown or
            missing, or a value is impossible.

    Example:
        >>> from sim import load_scenario
        >>> changes = {"friction": 0.5, "path.goal": [0.1, 0, 0]}
        >>> scenario = load_scenario("line", changes)
        >>> scenario.segments, scenario.friction, scenario.path.goal
        (40, 0.5, (0.1, 0.0, 0.0))
    """
    table, where = scenario_table(str(source))
    given = _plain(dict(overrides or {}))
    _anchor(given, "robot", Path.cwd(), ".xml")
    _anchor(given, "motion", Path.cwd())
    return scenario_from(table, given, where)


def _plain(value: Any) -> Any:
    """A value as a file would give it: arrays as lists, and texts for keys."""
    if isinstance(value, Mapping):
        return {str(key): _plain(inner) for key, inner in value.items()}
    return value.tolist() if hasattr(value, "tolist") else value


def scenario_table(source: str) -> tuple[Values, str]:
    """A scenario as its file gives it, found from anywhere, and its place in words."""
    write = f"write one: stratawalk scenarios line > {quote(f'{source}.toml')}"
    path = find(source, FOLDER, "scenario", "SCENARIO", write)
    table = {"name": path.stem, **read_toml(path)}
    if table.keys() & {"scenario", "grid", "list", "sobol", "keep"}:
        on = command("sweep", path, "--out", f"sweeps/{path.stem}")
        raise UsageError("a sweep and no scenario", str(path), on)
    anchor(table, path.parent)
    return table, str(path) if path.parent != FOLDER else f"scenario {source!r}"


def scenario_from(
    table: Table, overrides: Mapping[str, object], where: str
) -> Scenario:
    """A scenario from a table of plain values, found at a place in words.

    Overrides replace them; `path.goal` reaches into its table. A changed path loses the
    description, which is of another.
    """
    values = deepcopy(given := _renamed(table, where))
    for key, value in (changes := _renamed(overrides, where)).items():
        if (whole := key.partition(".")[0]) != key and whole in changes:
            raise UsageError.of("part_and_whole", where, key=key, whole=whole)
        _replace(values, key, value)
    if values.get("path") != given.get("path") and "description" not in overrides:
        values.pop("description", None)
    if "state" in values or "strata" in values:
        raise UsageError.of("a_system", where)
    for key in values:
        if key not in KEYS:
            near = did_you_mean(CALLED.get(key, key), KEYS)
            raise UsageError(f"unknown key {key!r}", where, near)
    if "motion" in values and "path" in values:
        raise UsageError.of("both_given", where)
    needed = ("name", "path") if "motion" not in values else ("name",)
    if lacking := [key for key in needed if key not in values]:
        raise UsageError(f"{lacking[0]} is missing", where, f"give {lacking[0]}")
    if isinstance(file := values.get("learnt"), str):
        values["learnt"] = _learnt(Path(file), values)
    standing = shapes.decode(values.get("obstacles", ()))
    path = nominal.decode(values["path"]) if "path" in values else nominal.line(START)
    own = {**values, "path": path, "obstacles": standing}
    return Scenario(**own, given=frozenset(changes))


def _learnt(path: Path, values: Table) -> object:
    """The numbers in a learnt.toml, or in that of a run of a robot of the same name."""
    file = (path if path.is_dir() else path.parent) / "scenario.toml"
    walked = read_toml(file) if file.is_file() else values
    own, asked = (str(t.get("robot", Scenario.robot)) for t in (walked, values))
    reshaped = walked.get("geometry") != values.get("geometry")
    if reshaped or Path(own).stem != Path(asked).stem:
        raise UsageError.of("learnt_of", path, own=own)
    path = path / "learnt.toml" if path.is_dir() else path
    table = read_toml(path).get("learnt")
    if not isinstance(table, dict) or "numbers" not in table:
        raise UsageError.of("not_learnt", path)
    return table["numbers"]


def anchor(table: Values, folder: Path) -> None:
    """Make the files that a scenario names findable from wherever it is read next."""
    _anchor(table, "robot", folder, ".xml")
    for key in ("learnt", "motion", "path.file"):
        _anchor(table, key, folder)
    if isinstance(table.get("path"), dict):
        _anchor(table["path"], "file", folder)


def _anchor(table: Values, key: str, folder: Path, suffix: str = "") -> None:
    name = table.get(key)
    if not isinstance(name, str) or not name.endswith(suffix):
        return
    try:
        real, link = (folder / name).resolve(), placed(folder / name)
        table[key] = str(link if link.with_suffix(".toml").exists() else real)
    except (ValueError, RuntimeError) as error:
        raise UsageError.of("no_file", folder, name=name, error=error) from error


def parse_override(text: str) -> tuple[str, object]:
    """Split `KEY=VALUE`; the value is TOML, a word without quotation marks is text."""
    key, equals, value = (part.strip() for part in text.partition("="))
    if not (key and equals and value):
        raise UsageError(f"{text!r} sets nothing", "--set", "write KEY=VALUE")
    try:
        table = parse_toml(f"value = {value}")
    except ValueError:
        return key, value
    return key, table["value"] if len(table) == 1 else value


def to_table(scenario: Scenario) -> Values:
    """The scenario as a table of plain values, as a file would give it."""
    values = {name: getattr(scenario, name) for name in SETTINGS}
    standing = [shapes.encode(obstacle) for obstacle in scenario.obstacles]
    return {
        **{name: value for name, value in values.items() if value is not None},
        **({} if scenario.motion else {"path": nominal.encode(scenario.path)}),
        **({"obstacles": standing} if standing else {}),
    }


def dumps(scenario: Scenario) -> str:
    """The scenario as TOML, each setting with its meaning, also those left open."""
    table = to_table(scenario)
    path, standing = table.pop("path", None), table.pop("obstacles", [])
    lines = []
    for key, item in SETTINGS.items():
        line = f"{key} = {toml_value(table[key])}" if key in table else f"# {key} ="
        lines.append(f"{line:30}  # {item.about}")
    tables = [("[path]", path)] if path else []
    for head, inner in [*tables, *(("[[obstacles]]", one) for one in standing)]:
        lines += ["", head]
        lines += [f"{key} = {toml_value(value)}" for key, value in inner.items()]
    return "\n".join(lines) + "\n"


def find(source: str, folder: Path, what: str, where: str, otherwise: str) -> Path:
    """A file of a kind by its path, or by its name a shipped one in a folder.

    A name that is unknown stood at a place, and one may do otherwise, both in words.
    """
    path, shipped = Path(source), sorted(file.stem for file in folder.glob("*.toml"))
    if source in shipped:
        return folder / f"{source}.toml"
    if path.is_dir():
        raise UsageError(f"a folder is not a {what}", source, "give a TOML file in it")
    if not path.is_file() and (path.suffix == ".toml" or len(path.parts) != 1):
        own = f"{path.stem!r}, as shipped, or " * (path.stem in shipped)
        raise UsageError.of("no_such_file", source, what=what, own=own)
    if not path.is_file():
        remedy = f"{did_you_mean(source, shipped)}; or {otherwise}"
        raise UsageError(f"unknown {what} {source!r}", where, remedy)
    return path


def read_toml(path: Path) -> Values:
    """A TOML file as a table."""
    with telling("cannot be read", path, "give a readable file", UsageError):
        try:
            return parse_toml(read_text(path))
        except ValueError as error:
            raise UsageError.of("not_toml", path, error=error) from error


def _replace(table: Values, key: str, value: object) -> None:
    *outer, last = key.split(".")
    for name in outer:
        inner = table.setdefault(name, {}) if name in TABLES else table.get(name)
        if not isinstance(inner, dict):
            raise UsageError(f"unknown key {key!r}", "--set", did_you_mean(key, KEYS))
        table = inner
    table[last] = value


def _renamed(table: Table, where: str) -> Values:
    """The table with the present names of settings that were called otherwise."""
    for old in table.keys() & FORMER.keys():
        if FORMER[old] in table:
            raise UsageError.of("renamed", where, old=old, new=FORMER[old])
        announce(old, FORMER[old])
    return {FORMER.get(key, key): value for key, value in table.items()}


@cache
def announce(old: str, new: str) -> None:
    """Print the present name of a setting, once."""
    say(f"stratawalk: notice: {old} is now called {new}")


def tell_of_run(source: Path, changed: Collection[str]) -> None:
    """Say whose settings a run has, of which another robot, or servo, is to walk."""
    other = any(key.startswith(("robot", "servo", "geometry")) for key in changed)
    if other and source.is_file() and source.with_name("summary.json").exists():
        told = "has all settings of a run, those that its robot gave as well"
        say(f"stratawalk: notice: {printable(' '.join(str(source).split()))} {told}")


def toml_value(value: object) -> str:
    """A value as TOML writes it."""
    if isinstance(value, str):
        return toml_text(value)
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, Mapping):
        inner = (f"{toml_key(k)} = {toml_value(v)}" for k, v in value.items())
        return f"{{ {', '.join(inner)} }}"
    if isinstance(value, Iterable):
        return f"[{', '.join(map(toml_value, value))}]"
    return repr(value)
