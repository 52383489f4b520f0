"""What lies in the folder where a command runs has no say in what it writes."""

import imageio.v3 as iio


def test_drawings_do_not_depend_on_a_file_of_the_working_folder(stratawalk, tmp_path):
    """Matplotlib would obey the file, and end with its last byte; one's own is used."""
    draw = ("plan", "heisenberg", "--segments", "1", "--out")
    (tmp_path / "mine").write_text("savefig.facecolor: black\n")
    assert stratawalk(*draw, "clean.png", MATPLOTLIBRC="mine").returncode == 0
    (tmp_path / "matplotlibrc").write_bytes(b"figure.figsize: 1, 1\n\xff")
    assert stratawalk(*draw, "watched.png", MATPLOTLIBRC="mine").returncode == 0
    clean, watched = (tmp_path / f"{name}.png" for name in ("clean", "watched"))
    assert clean.read_bytes() == watched.read_bytes()
    assert iio.imread(clean)[0, 0, :3].tolist() == [0, 0, 0]
