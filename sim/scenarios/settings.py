"""Kinds of settings: types, limits and the texts of refusals.

The settings themselves are declared in `scenarios.scenario`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import MISSING, Field, dataclass, field
from math import isfinite
from numbers import Real
from typing import Any, Protocol, TypeGuard


def is_number(value: object) -> TypeGuard[float]:
    """Whether a value is a real number; true and false are not."""
    return isinstance(value, Real) and not isinstance(value, bool)


class Kind(Protocol):
    """Decides whether a value is allowed, and describes what is."""

    def accept(self, value: object) -> object:
        """The value in its own type; raises ValueError if it is not allowed."""
        ...

    def __str__(self) -> str:
        """What is allowed, to follow the words "give"."""
        ...


@dataclass(frozen=True, slots=True)
class Number:
    """A finite number within limits."""

    low: float
    high: float
    above: bool = False  # low itself is not allowed
    whole: bool = False

    def accept(self, value: object) -> float | int:
        """The value as float, or as int where whole numbers are asked for.

        Raises:
            ValueError: If it is not a number, not finite, or outside the limits.
        """
        if not is_number(value) or not self.low <= value <= self.high:
            raise ValueError
        if (self.above and value == self.low) or (self.whole and value != int(value)):
            raise ValueError
        return int(value) if self.whole else float(value)

    def __str__(self) -> str:
        """For example `a number above 0 and up to 0.02`."""
        noun = "a whole number" if self.whole else "a number"
        low = f"above {self.low:g} and up" if self.above else f"from {self.low:g}"
        return f"{noun} {low} to {self.high:g}"


@dataclass(frozen=True, slots=True)
class Numbers:
    """A list of finite numbers, each within its own limits or all within the same."""

    each: tuple[Number, ...]
    any_length: bool = False  # as many as one likes, all as the first

    def accept(self, value: object) -> tuple[float, ...]:
        """The values as floats.

        Raises:
            ValueError: If it is no such list.
        """
        if not isinstance(value, list | tuple):
            raise ValueError
        kinds = self.each * len(value) if self.any_length else self.each
        if len(kinds) != len(value) or not value:
            raise ValueError
        pairs = zip(kinds, value, strict=True)
        return tuple(float(kind.accept(number)) for kind, number in pairs)

    def __str__(self) -> str:
        """For example `a list of 2 numbers`."""
        count = "" if self.any_length else f"{len(self.each)} "
        return f"a list of {count}numbers, {', '.join(map(str, self.each))}"


@dataclass(frozen=True, slots=True)
class Either:
    """One of several kinds, the first that takes the value."""

    kinds: tuple[Kind, ...]

    def accept(self, value: object) -> object:
        """The value in the type of the kind that takes it.

        Raises:
            ValueError: If none does.
        """
        for kind in self.kinds[:-1]:
            try:
                return kind.accept(value)
            except ValueError:
                continue
        return self.kinds[-1].accept(value)

    def __str__(self) -> str:
        """For example `a number from 0 to 1, or a list of numbers`."""
        return ", or ".join(map(str, self.kinds))


@dataclass(frozen=True, slots=True)
class Named:
    """Numbers with names, a table in a file."""

    def accept(self, value: object) -> dict[str, float]:
        """The numbers as floats.

        Raises:
            ValueError: If it is no table, or holds what is no finite number.
        """
        if not isinstance(value, Mapping) or not all(map(is_number, value.values())):
            raise ValueError
        if not all(map(isfinite, value.values())):
            raise ValueError
        return {str(name): float(number) for name, number in sorted(value.items())}

    def __str__(self) -> str:
        """What is allowed."""
        return "numbers by name, such as { kappa = 0.5 }"


@dataclass(frozen=True, slots=True)
class Choice:
    """One of a few words."""

    words: tuple[str, ...]

    def accept(self, value: object) -> str:
        """The value itself.

        Raises:
            ValueError: If it is none of the words.
        """
        if not isinstance(value, str) or value not in self.words:
            raise ValueError
        return value

    def __str__(self) -> str:
        """For example `paper or lifted`."""
        return " or ".join(self.words)


@dataclass(frozen=True, slots=True)
class Flag:
    """True or false."""

    def accept(self, value: object) -> bool:
        """The value itself.

        Raises:
            ValueError: If it is not a bool.
        """
        if not isinstance(value, bool):
            raise ValueError
        return value

    def __str__(self) -> str:
        """The two words of TOML."""
        return "true or false"


@dataclass(frozen=True, slots=True)
class Text:
    """Any text, or what can name something."""

    empty: bool = False
    file_name: bool = False

    def accept(self, value: object) -> str:
        """The value itself.

        Raises:
            ValueError: If it is not text, or empty, or no name for a file.
        """
        if not isinstance(value, str) or not (value or self.empty):
            raise ValueError
        if self.file_name and (
            "/" in value or value[0] in ".-" or not value.isprintable()
        ):
            raise ValueError
        return value

    def __str__(self) -> str:
        """What is allowed."""
        return "a name without slashes" if self.file_name else "text in quotation marks"


@dataclass(frozen=True, slots=True)
class Texts:
    """A list of texts."""

    def accept(self, value: object) -> tuple[str, ...]:
        """The texts.

        Raises:
            ValueError: If it is no list, or holds anything but texts, or nothing.
        """
        if not isinstance(value, list | tuple) or not value:
            raise ValueError
        return tuple(Text().accept(item) for item in value)

    def __str__(self) -> str:
        """What is allowed."""
        return "a list of texts in quotation marks"


def setting(kind: Kind, about: str, default: object = MISSING) -> Any:
    """A dataclass field that carries its limits and its meaning with it.

    Args:
        kind: What is allowed.
        about: Meaning, with the unit in brackets.
        default: Value when nothing is said; None leaves it to the robot or the run.

    Returns:
        A field for a keyword-only dataclass.
    """
    return field(default=default, metadata={"kind": kind, "about": about})


def kind_of(item: Field[Any]) -> Kind:
    """The kind of a setting.

    Args:
        item: Its field.
    """
    kind: Kind = item.metadata["kind"]
    return kind
