"""The command when nobody reads its output to the end."""

import os
import subprocess

from tests.commands import COMMAND, OUTSIDE


def test_a_reader_that_has_seen_enough_is_no_error(tmp_path):
    reading, writing = os.pipe()
    os.close(reading)
    done = subprocess.run(
        [*COMMAND, "systems"],
        cwd=tmp_path,
        env=OUTSIDE,
        stdout=writing,
        stderr=subprocess.PIPE,
        text=True,
    )
    os.close(writing)
    assert (done.returncode, done.stderr) == (0, "")
