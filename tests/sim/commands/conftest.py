"""The command in an empty folder, and robots of one's own there."""

import pytest

from models.description.robot import FOLDER
from tests import commands


@pytest.fixture
def stratawalk(tmp_path):
    """Run the real command in an empty folder."""

    def run(*words, **surroundings):
        return commands.run(words, tmp_path, **surroundings)

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
