"""The command in an empty folder."""

import subprocess

import pytest

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
