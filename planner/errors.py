"""What the planner can refuse, each with the value, the place and the way out."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from difflib import get_close_matches


def point(configuration: Iterable[float]) -> str:
    """A configuration as a message shows it: `(0.1, 0, -2)`."""
    return f"({', '.join(f'{value:.6g}' for value in configuration)})"


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """What to do about an unknown name: take the nearest known one, or another one.

    Args:
        name: The unknown name.
        known: The names that are known, in the order in which to list them.

    Returns:
        `did you mean 'line'? there are line, ellipse`, or without the question where no
        known name is near.
    """
    known = list(known)
    near = get_close_matches(name, known, n=1)
    question = f"did you mean {near[0]!r}? " if near else ""
    return f"{question}there are {', '.join(known) or 'none'}"


def unknown(name: str, known: Iterable[str]) -> str:
    """The end of a message on an unknown name: that it is unknown, and what to do."""
    return f"is unknown; {did_you_mean(name, known)}"


class PlannerError(Exception):
    """A request that the mathematics cannot serve; the root of this package's errors.

    Bad arguments (wrong shapes, unknown names, NaN) are ``ValueError`` instead.
    """

    def __reduce__(self) -> tuple[object, ...]:
        """Travel between processes, although subclasses are made from other values."""
        return Exception.__new__, (type(self), *self.args), self.__dict__


class SingularConfigurationError(PlannerError):
    """A field or path that has no finite value at a configuration."""

    def __init__(self, name: str, configuration: Iterable[float]) -> None:
        super().__init__(
            f"{name} is not finite at {point(configuration)}; "
            "keep the path away from this configuration"
        )


class FieldError(PlannerError):
    """A field's function that raises an error of its own."""

    def __init__(self, configuration: Iterable[float], error: BaseException) -> None:
        super().__init__(
            f"a field's function ends with {type(error).__name__} at "
            f"{point(configuration)}: {error}; correct it"
        )


class ResolutionError(PlannerError):
    """Segments along which inputs known at nodes do not follow the path in between.

    Attributes:
        segments: Indices of the segments; shorter ones may do.
    """

    def __init__(self, message: str, segments: Sequence[int]) -> None:
        self.segments = tuple(segments)
        super().__init__(message)


class RankError(PlannerError):
    """Elements that do not span the bottom stratum's tangent space (Def. 3)."""

    def __init__(
        self, configuration: Iterable[float], needed: int, missing: Sequence[str]
    ) -> None:
        """Compose the message.

        Args:
            configuration: Where they do not.
            needed: Dimension of the bottom stratum.
            missing: Directions that they lack, in words.
        """
        self.rank, self.needed = needed - len(missing), needed
        self.missing = tuple(missing)
        super().__init__(
            f"the extended system has rank {self.rank} of {needed} at "
            f"{point(configuration)} (Def. 3), nothing along {', '.join(missing)}; "
            "add fields or brackets, or keep the path away from there"
        )


class RangeError(PlannerError):
    """A plan that leaves the range of a shape variable.

    Attributes:
        segments: Number of segments that would do, None if none was found.
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
        """Compose the message.

        Args:
            name: The shape variable.
            reached: The value that it would have.
            low: The lowest that it may have.
            high: The highest.
            segments: Number of segments that would do.
            hopeless: Why there is no such number, as far as that is known.
        """
        self.name, self.reached, self.low, self.high = name, reached, low, high
        self.segments = segments
        widen = "widen the range or shorten the path"
        why = f"{hopeless}; {widen}" if hopeless else widen
        way_out = f"plan at least {segments} segments" if segments else why
        super().__init__(
            f"{name} would reach {reached:.4g}, outside its range {low:.4g} to "
            f"{high:.4g}; {way_out}"
        )

    def with_segments(self, segments: int | None, hopeless: str = "") -> RangeError:
        """The same refusal with a number of segments that would do, or why none."""
        place = self.name, self.reached, self.low, self.high
        return RangeError(*place, segments, hopeless)


class BoundError(PlannerError):
    """A lower bound that no plan, or none of a sensible number of segments, keeps."""


class StratumError(PlannerError):
    """A change of stratum, or a walk of several, that the strata do not allow."""


class ConvergenceError(PlannerError):
    """A flow, or a series of shots, that does not converge."""


class DecouplingError(PlannerError):
    """A lift that does not commute with a field used while the foot is up (eq. 13)."""

    def __init__(self, lift: str, field: str) -> None:
        self.lift, self.field = lift, field
        super().__init__(
            f"[{lift},{field}] does not vanish, so lifting changes what {field} does "
            "(eq. 13); make the field independent of foot height (Assumption 2)"
        )
