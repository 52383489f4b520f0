"""Loading of robots: shipped ones by name, those of users by their MJCF file."""

from collections.abc import Mapping
from dataclasses import replace
from difflib import get_close_matches
from os import PathLike, fspath
from os.path import lexists, realpath
from pathlib import Path
from shlex import quote

from models.checks import check_parts, check_posture
from models.description.card_file import card_text, parse_card
from models.description.compiled import read_spec
from models.description.inspection import Opened, inspect_model
from models.description.robot import EMBEDDED, FOLDER, Robot
from models.errors import ModelError, UnknownRobotError, message
from models.morphology.mjcf import write_mjcf
from models.morphology.shipped import reshaped


def shipped_robots() -> tuple[str, ...]:
    """Names of the shipped robots.

    Example:
        >>> from models import shipped_robots
        >>> shipped_robots()[:2]
        ('hexapod', 'hexapod-classroom')
    """
    return tuple(sorted(path.stem for path in FOLDER.glob("*.toml")))


def load(
    name: str | PathLike[str],
    *,
    allow_external: bool = False,
    geometry: Mapping[str, float] | None = None,
) -> Robot:
    """A shipped robot by name, or a user's own by the path of its MJCF file.

    The card is the TOML file beside it, or its custom text `card`. A file with neither
    is given the card of the shipped robot whose model name it carries.

    Args:
        name: Name or path.
        allow_external: Whether a user's own may open files outside its folder.
        geometry: Numbers of a shipped robot's shape that are changed, by name.

    Raises:
        UnknownRobotError: If there is no such robot or file.
        ModelError: If file, card or geometry cannot be used, or the model is too large
            or opens what it may not.

    Example:
        >>> from models import load
        >>> robot = load("hexapod")
        >>> robot.legs, robot.groups
        ((1, 2, 3, 4, 5, 6), ('1', '2'))
    """
    path, opened = _find(fspath(name)), Opened()
    beside = path.with_suffix(".toml")
    if path.parent != FOLDER:
        cards = (beside,) if lexists(beside) else ()
        opened = inspect_model(path, cards, allow_external)
    text, source = _card(path, beside)
    borrowed = Path(source).stem if Path(source).parent == FOLDER != path.parent else ""
    robot = Robot(path.stem, path, text, parse_card(text, source), opened, borrowed)
    if geometry:
        if not robot.is_shipped:
            raise ModelError(message("own", keys=", ".join(geometry), path=robot.path))
        try:
            shape = reshaped(robot.name, geometry)
        except ValueError as error:
            raise ModelError(f"{robot.name}: {error}") from error
        groups = [group.legs for group in robot.card.groups.values()]
        robot = replace(robot, geometry=dict(geometry), text=write_mjcf(shape, groups))
    try:
        check_parts(robot)
    except ModelError as error:
        if not borrowed:
            raise
        facts = {"beside": beside, "borrowed": borrowed, "error": error}
        raise ModelError(message("no_card", **facts)) from error
    check_posture(robot)
    return robot


def _find(name: str) -> Path:
    shipped = shipped_robots()
    if not name.endswith(".xml") and name not in shipped:
        file = [f"{name}.xml"] if Path(f"{name}.xml").is_file() else []
        near = file or get_close_matches(name, shipped, n=1)
        own = quote(name) if name.endswith(".urdf") else "FILE.urdf"
        question = f"did you mean {near[0]!r}? " if near else ""
        facts = {"question": question, "shipped": ", ".join(shipped), "own": own}
        raise UnknownRobotError(message("unknown_robot", name=name, **facts))
    path = Path(name) if name.endswith(".xml") else FOLDER / f"{name}.xml"
    if realpath(path.parent) == realpath(FOLDER):  # by whatever way it is named
        path = FOLDER / path.name
    if not path.is_file():
        own = f"{path.stem!r}, as shipped, or " * (path.stem in shipped)
        raise UnknownRobotError(message("no_file", path=path, own=own))
    return path


def _card(path: Path, beside: Path) -> tuple[str, str]:
    """Text of a robot's card, and where it stands."""
    spec = read_spec(path)
    inside = [text.data for text in spec.texts if text.name == EMBEDDED]
    own = f"custom text {EMBEDDED!r} in {path}"
    if inside and lexists(beside):
        raise ModelError(f"two robot cards: {beside}, and the {own}; keep one of them")
    if inside:
        return inside[0], own
    if lexists(beside):
        return card_text(beside), str(beside)
    if spec.modelname in shipped_robots():
        shipped = FOLDER / f"{spec.modelname}.toml"
        return card_text(shipped), str(shipped)
    remedy = f"draft one: stratawalk adopt {quote(str(path))}"
    raise ModelError(f"no robot card: {beside} is missing; {remedy}")
