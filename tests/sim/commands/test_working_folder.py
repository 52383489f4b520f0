"""What lies in the folder where a command runs has no say in what it writes."""


def test_drawings_do_not_depend_on_settings_of_matplotlib(stratawalk, tmp_path):
    """Those of a person may ask for LaTeX, those of a folder end with a wrong byte."""
    draw = ("plan", "heisenberg", "--segments", "1", "--out")
    assert stratawalk(*draw, "clean.png").returncode == 0
    (tmp_path / "mine").write_text("text.usetex: True\nsavefig.facecolor: black\n")
    assert stratawalk(*draw, "owned.png", MATPLOTLIBRC="mine").returncode == 0
    (tmp_path / "matplotlibrc").write_bytes(b"figure.figsize: 1, 1\n\xff")
    assert stratawalk(*draw, "watched.png").returncode == 0
    clean = (tmp_path / "clean.png").read_bytes()
    assert (tmp_path / "owned.png").read_bytes() == clean
    assert (tmp_path / "watched.png").read_bytes() == clean
