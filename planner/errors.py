"""Errors of the planner, and tables of sentences, that give value, place and remedy."""

import tomllib
from collections.abc import Callable, Collection, Iterable, Sequence
from difflib import get_close_matches
from importlib.resources import files
from pathlib import Path
from typing import Any

MANY = 40  # names, too many for a line
SETUP = Path(__file__).parents[1] / "scripts" / "setup"  # in a checkout


def shipped_tables(package: str, name: str) -> dict[str, Any]:
    """The tables of a TOML file that lies in one of our packages."""
    return tomllib.loads((files(package) / name).read_text("utf-8"))


def sentences(package: str, name: str) -> Callable[..., str]:
    """Says a sentence of such a file by its key, facts put in where they belong."""
    tables = shipped_tables(package, name)
    return lambda key, /, **facts: str(tables[key]).format(**facts)


message = sentences("planner", "refusals.toml")


def point(configuration: Iterable[float]) -> str:
    """A configuration as it is written in messages: `(0.1, 0, -2)`."""
    return f"({', '.join(f'{value:.6g}' for value in configuration)})"


def installing(extra: str) -> str:
    """What installs an extra: a checkout's own command, or else pip."""
    if SETUP.exists():
        return f"{SETUP} installs all extras"
    return f"pip install 'stratawalk[{extra}]'"


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """Suggestion for an unknown name: the nearest known one, and all known ones.

    It reads `did you mean 'line'? there are line, ellipse`, without the question where
    no known name is near or has it as a word, and without the list where that is long.
    """
    known = list(known)
    near = get_close_matches(name, known, n=1)
    near = near or [one for one in known if name in one.split("_")]
    if near and len(known) > MANY:
        return f"did you mean {near[0]!r}?"
    question = f"did you mean {near[0]!r}? " if near else ""
    are, listed = "is only" if len(known) == 1 else "are", ", ".join(known) or "none"
    return f"{question}there {are} {listed}"


def unknown(name: str, known: Iterable[str]) -> str:
    """The end of a message on an unknown name: that it is unknown, and what to do."""
    return f"is unknown; {did_you_mean(name, known)}"


def require_known(
    what: str, name: str, known: Collection[str], error: type[Exception] = ValueError
) -> None:
    """Raise an error, `{what} is unknown; ...`, unless a name is among the known."""
    if name not in known:
        raise error(f"{what} {unknown(name, known)}")


class PlannerError(Exception):
    """A request that cannot be satisfied; the base class of this package's errors.

    Invalid arguments (wrong shapes, unknown names, NaN) raise ``ValueError`` instead.

    Example:
        >>> from planner import PlannerError, RankError
        >>> issubclass(RankError, PlannerError)
        True
    """

    def __reduce__(self) -> tuple[object, ...]:
        """Support pickling, since subclasses take other arguments than the message."""
        return Exception.__new__, (type(self), *self.args), self.__dict__


class SingularConfigurationError(PlannerError):
    """A field that has no finite value at a configuration.

    Example:
        >>> from planner import SingularConfigurationError
        >>> print(SingularConfigurationError("g1_1", (0, 0)))
        g1_1 is not finite at (0, 0); keep the path away from this configuration
    """

    def __init__(self, name: str, configuration: Iterable[float]) -> None:
        super().__init__(message("infinite", name=name, at=point(configuration)))


class FieldError(PlannerError):
    """A field's function that raises an error of its own."""

    def __init__(self, configuration: Iterable[float], error: BaseException) -> None:
        facts = {"kind": type(error).__name__, "at": point(configuration)}
        super().__init__(message("field_fails", error=error, **facts))


class ResolutionError(PlannerError):
    """Segments whose inputs, known at nodes, do not follow the path between the nodes.

    Attributes:
        segments: Indices of the segments. Shorter segments may be followed.

    Example:
        >>> from planner import ResolutionError
        >>> ResolutionError("2 segments are too long", segments=[0, 3]).segments
        (0, 3)
    """

    def __init__(self, message: str, segments: Sequence[int]) -> None:
        self.segments = tuple(segments)
        super().__init__(message)


class RankError(PlannerError):
    """Elements that do not span the tangent space of the bottom stratum (Def. 3).

    Example:
        >>> from planner import RankError
        >>> error = RankError((0, 0, 0), needed=3, missing=["z"])
        >>> error.rank, error.missing
        (2, ('z',))
    """

    def __init__(
        self,
        configuration: Iterable[float],
        needed: int,
        missing: Sequence[str],
        enough: int | None = None,
    ) -> None:
        """Take the degree of brackets that would be enough, if there is one."""
        self.rank, self.needed = needed - len(missing), needed
        self.missing = tuple(missing)
        way_out = "add fields or brackets, or keep the path away from there"
        if enough:
            way_out = f"brackets to degree {enough} suffice: name them, or choose with "
            way_out += f"max_degree={enough}"
        facts = {"at": point(configuration), "missing": ", ".join(missing)}
        line = message("singular", rank=self.rank, needed=needed, **facts)
        super().__init__(f"{line}; {way_out}")


class RangeError(PlannerError):
    """A plan that leaves the range of a shape coordinate.

    Attributes:
        segments: Number of segments that keep the range; None if none was found, for
            the reason that `hopeless` gives.

    Example:
        >>> from planner import RangeError
        >>> print(RangeError("phi1", 0.5, -0.45, 0.45, segments=8))
        phi1 would reach 0.5, outside its range -0.45 to 0.45; plan at least 8 segments
    """

    def __init__(
        self,
        name: str,
        reached: float,
        low: float,
        high: float,
        segments: int | None = None,
        hopeless: str = "",
    ) -> None:
        self.name, self.reached, self.low, self.high = name, reached, low, high
        self.segments = segments
        widen = "widen the range or shorten the path"
        why = f"{hopeless}; {widen}" if hopeless else widen
        way_out = f"plan at least {segments} segments" if segments else why
        facts = {"name": name, "reached": reached, "low": low, "high": high}
        super().__init__(f"{message('beyond_range', **facts)}; {way_out}")

    def with_segments(self, segments: int | None, hopeless: str = "") -> "RangeError":
        """The same error with a number of segments that suffice, or why none does."""
        place = self.name, self.reached, self.low, self.high
        return RangeError(*place, segments, hopeless)


class BudgetError(PlannerError):
    """A search that exceeds its time limit.

    Example:
        >>> from planner import BudgetError
        >>> print(BudgetError(2.0, best="12 segments"))
        none within 2 s; it had come to 12 segments; ask for fewer segments or more time
    """

    def __init__(self, seconds: float, best: str) -> None:
        come_to = f"it had come to {best}" if best else "nothing was found yet"
        super().__init__(message("out_of_time", seconds=seconds, come_to=come_to))


class BoundError(PlannerError):
    """A bound that no plan keeps with a reasonable number of segments.

    Example:
        >>> from planner import BoundError, PlannerError
        >>> issubclass(BoundError, PlannerError)
        True
    """


class StratumError(PlannerError):
    """A change of stratum, or a sequence of them, that the system does not allow.

    Example:
        >>> from planner import StratifiedSystem
        >>> StratifiedSystem("x", {"1": {"f": [1]}, "2": {}}, "1").switches("1", "2")
        Traceback (most recent call last):
        planner.errors.StratumError: no chain of nested strata joins S1 to S2; ...
    """


class ConvergenceError(PlannerError):
    """A flow, or a sequence of shots, that does not converge.

    Example:
        >>> from planner import StratifiedSystem, flow_map
        >>> system = StratifiedSystem("x", {"0": {"f": ["x**2"]}}, "0")
        >>> flow_map(system, "f", [1.0], 2.0)
        Traceback (most recent call last):
        planner.errors.ConvergenceError: ... escapes ...
    """


class DecouplingError(PlannerError):
    """A lift field that does not commute with a field used in the air, eq. (13).

    Example:
        >>> from planner import DecouplingError
        >>> error = DecouplingError("lift", "swing")
        >>> error.lift, error.field
        ('lift', 'swing')
    """

    def __init__(self, lift: str, field: str) -> None:
        self.lift, self.field = lift, field
        super().__init__(message("coupled", lift=lift, field=field))
