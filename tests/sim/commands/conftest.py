"""The command in an empty folder, and robots of one's own there."""

import subprocess

import pytest

from models.description.robot import FOLDER
from tests.commands import COMMAND, OUTSIDE


@pytest.fixture
def stratawalk(tmp_path):
    """Run the real command in an empty folder."""

    def run(*words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, **environment):
        return subprocess.run(
            [*COMMAND, *words],
            cwd=tmp_path,
            env=OUTSIDE | environment,
            stdout=stdout,
            stderr=stderr,
            text=True,
        )

    return run


@pytest.fixture
def robot(tmp_path):
    """Write the shipped hexapod with a text replaced in its MJCF or card."""

    def write(old, new, encoding="utf-8"):
        for name in ("hexapod.xml", "hexapod.toml", "scene.xml"):
            text = (FOLDER / name).read_text().replace(old, new)
            path = tmp_path / name.replace("hexapod", "mine")
            path.write_text(text, encoding=encoding)
        return "mine.xml"

    return write
