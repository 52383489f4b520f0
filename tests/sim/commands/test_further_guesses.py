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
        ("run --gait 12 1 12 2 ellipse", "stratawalk run ellipse --gait 12 1 12 2"),
        ("run --gait 12 1 my.toml", "stratawalk run my.toml --gait 12 1"),
        ("run --segments 3", "stratawalk run line --segments 3"),
        ("run line --segments 2 --segments=3", "--segments is given twice: stratawalk"),
        ("run line --video --no-video", "--no-video is given twice: stratawalk run"),
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
        ("plan car -o a.png", "write --out a.png"),
        ("run line -o", "write --out NAME"),
        ("run line --set goal=[0.1,0,0]", "write --set 'path.goal=[0.1, 0, 0]'"),
        ("run line --replan true", "--replan stands alone"),
        ("run --robot hexapod", "for example: stratawalk run line --robot hexapod"),
        ("drive", "for example: stratawalk drive line --robot hexapod --pace 0"),
        ("sweep foo", "unknown sweep 'foo'"),
        ("sweep legs", "--out missing: stratawalk sweep; add --out sweeps/legs"),
        (
            "export mine.xml --format csv --out a.csv",
            "stratawalk export line --robot m",
        ),
        ("plan bare.toml", "bad system: bare.toml; strata is missing"),
        ("systems bare.toml", "`check` and `plan` read files"),
        ("study sweep.toml", "give stratawalk sweep this file"),
        ("show a/report.html", "give its folder, a"),
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
    (tmp_path / "bare.toml").write_text('state = ["x"]\ngoal = { x = 1 }\n')
    (tmp_path / "sweep.toml").write_text('scenario = "line"\n')
    (tmp_path / "a").mkdir()
    for name in ("summary.json", "report.html"):
        (tmp_path / "a" / name).touch()
    assert main(words.split()) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert meant in line


@pytest.mark.parametrize(
    ("words", "meant"),
    [
        (["run", "line", "--set servo=mg90"], "two words: --set servo=mg90\n"),
        (["run", "line", "--servo", "mg90"], "write --set servo=mg90\n"),
    ],
)
def test_what_is_to_be_pasted_ends_the_line(words, meant, capsys):
    assert main(words) == 2
    assert capsys.readouterr().err.endswith(meant)


@pytest.mark.parametrize(
    ("goal", "told"),
    [
        ("[0.1, 0, 90]", "yaw is in radians: 90 degrees is 1.5708"),
        ("[20, 20, 0]", "x and y are in metres: the goal is 28.2843 m away"),
        ("[0.1, 0.2, 3.1]", ""),
    ],
)
def test_a_goal_that_looks_like_degrees_or_millimetres_is_told_its_units(
    goal, told, capsys
):
    main(["plan", "line", "--set", f"path.goal={goal}", "--segments", "1", "--json"])
    out, err = capsys.readouterr()
    notices = [line for line in err.splitlines() if ": notice:" in line]
    assert notices == [f"stratawalk: notice: {told}"] * bool(told)
    assert "notice" not in out


def test_a_box_that_looks_turned_by_degrees_is_told_its_unit(tmp_path, capsys):
    box = '[[obstacles]]\nkind = "box"\ncenter = [0, 1]\nsize = [0.1, 0.1]\nyaw = 45\n'
    path = tmp_path / "box.toml"
    path.write_text(f'[path]\nkind = "line"\ngoal = [0.005, 0, 0]\n{box}')
    assert main(["plan", str(path), "--segments", "1"]) == 0
    told = "yaw of an obstacle is in radians: 45 degrees is 0.7854"
    assert told in capsys.readouterr().err


def test_a_heading_of_a_system_that_looks_like_degrees_is_told_its_unit(capsys):
    assert main(["plan", "unicycle", "--goal", "theta=90", "--segments", "40"]) == 0
    assert "theta is in radians: 90 degrees is 1.5708" in capsys.readouterr().err
