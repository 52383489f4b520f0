"""Refusals and guesses in words, whose sentences `words.toml` has."""

from models.errors import refusals
from planner.support import sentences

refusal = refusals("models.adoption", "words.toml")
guess = sentences("models.adoption", "words.toml")
SHOWN = 2  # names in a sentence


def first(names: list[str]) -> str:
    """The first of some names, and how many more there are."""
    more = len(names) - SHOWN
    return ", ".join(names[:SHOWN]) + (f" and {more} more" * (more > 0))
