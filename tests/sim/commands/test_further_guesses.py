"""Further guesses of a teacher, a builder and a researcher who have read nothing."""

import pytest

from sim.cli import main


@pytest.mark.parametrize(
    ("words", "meant"),
    [
        (
            "sweep --friction 0.3,0.6",
            "stratawalk run line --set friction=0.3; for a sweep",
        ),
        ("plan --robot car --trailer", "plan car-trailers --set trailers=1"),
        ("run --goal 0.1 0.1 0", "write --set 'path.goal=[0.1, 0.1, 0]'"),
        ("run line --legs 4", "stratawalk robots lists them"),
        ("run line --slow", "write --set swing_speed=0.2"),
        ("run line --rotate 90", "write --set 'path.goal=[0, 0, 0.3]', in radians"),
        ("run line --dof 3", "stratawalk robots lists them"),
        ("run line --weight 2", "write --set 'payload=[2, 0, 0, 0]'"),
        ("run line --gravity 1.6", "--set 'slope=[0.1, 0]' leans the floor"),
        ("run line -n 10", "write --segments 10"),
        ("run line --quiet", "write --json"),
        ("run line --no-film", "write --no-video"),
        ("run line --gpu", "leave it out"),
        ("run line --zzz", "stratawalk run --help lists all options"),
        ("run line --seed=random", "write --set seed=random (a whole number"),
        ("run line set friction=0.5", "write --set"),
        ("export line format csv", "--out missing: stratawalk export; for example"),
        ("figures fig3", "write --only quadruped"),
        ("figures --fig 3", "write --only line"),
        ("cite --bibtex", "stratawalk cite prints BibTeX"),
        ("help stroke", "docs/glossary.md defines the terms"),
        ("what is a bracket", "docs/glossary.md defines the terms"),
        ("arduino", "try stratawalk export line --robot hexapod-classroom"),
        ("joystick", "try stratawalk drive line --pace 0"),
        ("update", "git pull and scripts/setup"),
        ("scenarios --new mine.toml", "stratawalk scenarios line > mine.toml"),
        ("run models/robots/hexapod.xml", "stratawalk run line --robot models/robots"),
        ("compare runs/*", "stratawalk show"),
    ],
)
def test_a_further_guess_is_answered_with_a_command_that_works(
    words, meant, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    assert main(words.split()) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert meant in line
