"""What commands answer to first tries, and say before anything has been read."""

import json

import pytest

from models.systems.catalogue import shipped_system
from sim.cli import main
from sim.commands.declared import COMMANDS


@pytest.fixture
def stratawalk(tmp_path, monkeypatch, capsys):
    """Run the command here, in an empty folder: code, output and messages."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("sim.problems.problem.TRIAL_TIME", 0.0)  # tried in tests of it

    def run(*words):
        code = main(words)
        return code, *capsys.readouterr()

    return run


@pytest.fixture
def facts(stratawalk):
    """What the command prints as JSON."""
    return lambda *words: json.loads(stratawalk(*words, "--json")[1])


@pytest.mark.parametrize(
    ("words", "meant"),
    [
        ("plan line --goal x=1 theta=0.5", "write --set 'path.goal=[1, 0, 0.5]'"),
        ("plan line --goal y=0.2", "write --set 'path.goal=[0, 0.2, 0]'"),
        ("show latest", "no run here: runs; walk one: stratawalk run line"),
        ("run line --segments four", "'four' is not allowed: --segments; give a whole"),
        ("run line --segments", "needs a value after it: --segments; for exam"),
        ("run line --json=3", "takes no value, but was given '3': --json; for example"),
        ("bench --fast", "stratawalk bench --help lists all options"),
        ("film --from soon", "soon is not a time: --from; give a number such as 5"),
        (
            "run line --set dead_band=0.5deg",
            "a list of numbers 0 or from 1e-09 to 0.2 [rad]",
        ),
        ("list", "unknown command 'list': stratawalk; try stratawalk robots"),
    ],
)
def test_a_refusal_names_the_way_out(stratawalk, words, meant):
    code, _, err = stratawalk(*words.split())
    assert code == 2
    (line,) = err.splitlines()
    assert meant in line


def test_strata_may_be_written_as_they_are_printed(facts):
    plain, printed = (
        facts("check", "biped", "--gait", f"{s}12", f"{s}1", f"{s}12")
        for s in ("", "S")
    )
    assert plain == printed


def test_a_stratum_that_a_gait_leaves_out_is_named(stratawalk):
    _, out, _ = stratawalk("check", "hexapod", "--gait", "12", "1", "12")
    assert "verdict     controllable" in out
    assert "left out    S2, which the strokes below use" in out
    _, out, _ = stratawalk("check", "hexapod")
    assert "left out" not in out


def test_plans_take_strata_as_they_are_printed(facts):
    """So do scenarios, whose errors have no second S then."""
    short = ("--segments", "4", "--set", "path.goal=[0.03, 0.03, 0]")
    for what in (("biped",), ("line", *short)):
        plain, printed = (
            facts(
                "plan",
                *what,
                "--gait",
                *(f"{s}{n}" for n in ("12", "1", "12", "2", "12")),
            )
            for s in ("", "S")
        )
        assert plain["contact_switches"] == printed["contact_switches"]
        assert plain.get("end", plain.get("pose")) == printed.get(
            "end", printed.get("pose")
        )


@pytest.mark.parametrize("system", ["car", "finger-gaiting"])
def test_the_way_of_a_plan_is_drawn_with_its_coordinates_at_the_axes(
    stratawalk, tmp_path, system
):
    """The second coordinate over the first; it may be a saved plan, too."""
    code, out, _ = stratawalk("plan", system, "--out", "way.svg", "--save", "a.json")
    assert (code, out.splitlines()[-1]) == (0, "picture   way.svg")
    drawn = (tmp_path / "way.svg").read_text()
    names = [str(symbol) for symbol in shipped_system(system).system.state]
    for name in names[:2]:
        assert f"<!-- {name} -->" in drawn
    assert stratawalk("plan", "a.json", "--out", "again.png")[0] == 0
    assert (tmp_path / "again.png").read_bytes().startswith(b"\x89PNG")


def test_inputs_of_a_chained_form_are_defined_where_they_are_printed(stratawalk):
    """Brackets of fields have the fields' own names, and no such line."""
    _, chained, _ = stratawalk("plan", "car-trailers")
    assert "inputs    ahead moves the first flat output by one in a unit of" in chained
    _, other, _ = stratawalk("plan", "car-trailers", "--degree", "4", "--segments", "1")
    assert "inputs" not in other


def test_check_says_what_it_judges_and_of_one_stratum_nothing_of_others(stratawalk):
    _, out, _ = stratawalk("check", "hexapod-parallel")
    assert "what it is  The paper's Figs. 1 and 5 taken literally" in out
    assert "it turns on paper only" in out
    assert "brackets across strata, too (Def. 3)" in out
    _, out, _ = stratawalk("check", "car-trailers")
    assert "across strata" not in out
    assert "rank 5 of 5, the same, as there is one stratum (Def. 3)" in out
    for system, across in (("biped", True), ("finger-gaiting", False)):  # no brackets
        _, out, _ = stratawalk("check", system)
        assert ("plans steer by brackets across strata" in out) is across


def test_help_of_set_says_how_a_system_is_changed(stratawalk):
    _, out, _ = stratawalk("plan", "--help")
    assert "a parameter such as trailers=2 (`stratawalk systems`" in " ".join(
        out.split()
    )


def test_of_an_optimised_plan_no_convergence_is_told(facts):
    """It ends at its goal in any number of segments, unlike the stratified plan."""
    options = "plan", "unicycle", "--segments", "1"
    assert facts(*options)["accuracy"]["order"] == 0.5
    found = facts(*options, "--optimise", "time")
    assert (found["steps"], found["accuracy"]) == (None, None)


def test_an_option_that_resembles_no_setting_is_not_taken_for_one(stratawalk):
    _, _, said = stratawalk("run", "line", "--frobnicate")  # somewhat like friction
    assert "unknown option --frobnicate: stratawalk run; stratawalk run --help" in said


@pytest.mark.parametrize("name", ["completion", "export", "run"])
def test_examples_stand_on_one_line_of_the_help(name, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "60")
    assert main([name, "--help"]) == 0
    (line,) = (
        line for line in capsys.readouterr().out.splitlines() if "for example" in line
    )
    assert line == f"for example: {' '.join(COMMANDS[name]['example'].split())}"


@pytest.mark.parametrize(
    "words",
    [
        ("show", ""),
        ("film", ""),
        ("play", "hexapod", ""),
        ("fit", "hexapod", "a.csv", "--out", ""),
    ],
)
def test_nothing_is_called_by_an_empty_name(stratawalk, words):
    """The newest run was shown, and the working folder read."""
    code, _, said = stratawalk(*words)
    assert (code, "an empty name: " in said) == (2, True)


@pytest.mark.parametrize("command", ["play", "fit"])
def test_a_log_that_is_named_twice_does_not_count_twice(stratawalk, command):
    code, _, said = stratawalk(command, "hexapod", "a", "./a")
    assert (code, "named twice: a; name it once" in said) == (2, True)
