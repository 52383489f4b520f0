"""Files that anybody may have written are read up to a size."""

import pytest

from sim.errors import UsageError
from sim.logs import log
from sim.scenarios import body_path


class AskedError(ValueError):
    """How large a file may be."""


def asked(path, largest):
    raise AskedError(f"{largest} bytes")


@pytest.mark.parametrize(
    ("module", "reader", "read"),
    [(body_path, "read_text", "_read_poses"), (log, "read_file", "_table")],
    ids=["poses", "logs"],
)
def test_poses_and_logs_have_a_hundred_megabytes_at_most(
    module, reader, read, monkeypatch
):
    monkeypatch.setattr(module, reader, asked)
    with pytest.raises((AskedError, UsageError), match="100000000 bytes"):
        getattr(module, read)("any.csv")
