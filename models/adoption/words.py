"""Refusals and guesses in words, whose sentences `words.toml` has."""

from models.errors import refusals
from planner.support import sentences

refusal = refusals("models.adoption", "words.toml")
guess = sentences("models.adoption", "words.toml")
