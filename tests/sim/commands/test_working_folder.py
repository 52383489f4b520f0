"""What lies in the folder where a command runs has no say in what it writes."""

import pytest


@pytest.mark.parametrize("words", ["figure.dpi: 7", "\xff"])
def test_drawings_do_not_depend_on_a_file_of_the_working_folder(
    stratawalk, tmp_path, words
):
    """Matplotlib would obey the file, or end with it; a file of one's own is used."""
    draw = ("figures", "--only", "mechanism", "--out")
    (tmp_path / "mine").write_text("savefig.dpi: 50\n")
    assert stratawalk(*draw, "clean", MATPLOTLIBRC="mine").returncode == 0
    (tmp_path / "matplotlibrc").write_bytes(words.encode("latin-1"))
    assert stratawalk(*draw, "watched", MATPLOTLIBRC="mine").returncode == 0
    made = [next((tmp_path / name).glob("*.png")) for name in ("clean", "watched")]
    assert made[0].read_bytes() == made[1].read_bytes()
