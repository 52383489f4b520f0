"""Robots of strangers are tried without the start of a process each."""

import pytest

from models.description import inspection
from tests.trials import FORKED


@pytest.fixture(autouse=True)
def trials(monkeypatch):
    monkeypatch.setattr(inspection, "subprocess", FORKED)
