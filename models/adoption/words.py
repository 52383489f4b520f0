"""Refusals and guesses in words, whose sentences `words.toml` has."""

from __future__ import annotations

from models.errors import ModelError
from planner.support import shipped_tables

WORDS = shipped_tables("models.adoption", "words.toml")


def refusal(problem: str, source: object, /, **facts: object) -> ModelError:
    """Why the robot of a file cannot be adopted, and the way out."""
    return ModelError(str(WORDS["refused"][problem]).format(source=source, **facts))


def guess(what: str, /, **facts: object) -> str:
    """What was guessed, and from what."""
    return str(WORDS["guessed"][what]).format(**facts)
