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
    ("module", "reader", "read", "size"),
    [
        (body_path, "read_text", "_read_poses", 5 * 10**7),
        (log, "read_file", "_table", 10**8),
    ],
    ids=["poses", "logs"],
)
def test_poses_have_fifty_megabytes_at_most_and_logs_a_hundred(
    module, reader, read, size, monkeypatch
):
    monkeypatch.setattr(module, reader, asked)
    with pytest.raises((AskedError, UsageError), match=f"{size} bytes"):
        getattr(module, read)("any.csv")
