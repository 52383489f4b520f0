"""Texts that somebody has written are read up to a size that nobody writes."""

import pytest

from planner.support.files import read_file, read_text


def test_texts_have_ten_megabytes_at_most(tmp_path):
    for size in (10**7, 10**7 + 1):
        with (tmp_path / str(size)).open("wb") as file:
            file.truncate(size)
    assert len(read_text(tmp_path / str(10**7))) == 10**7
    for read in (read_file, read_text):
        with pytest.raises(OSError, match="larger than 10 MB"):
            read(tmp_path / str(10**7 + 1))
