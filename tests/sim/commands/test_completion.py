"""Shells complete the words of the command."""

import subprocess

import pytest

from models.library import shipped_robots
from sim.cli import main
from sim.scenarios.file import shipped_scenarios


@pytest.fixture
def completed(tmp_path, capsys):
    """What bash completes the last of some words to."""
    assert main(["completion", "bash"]) == 0
    script = tmp_path / "completion.sh"
    script.write_text(capsys.readouterr().out)

    def complete(*words):
        line = " ".join(words)
        program = (
            f'source "{script}"; COMP_WORDS=({line}); COMP_CWORD={len(words) - 1}; '
            f'COMP_LINE="{line}"; _shtab_stratawalk; echo "${{COMPREPLY[@]}}"'
        )
        done = subprocess.run(
            ["bash", "-c", program], capture_output=True, text=True, check=True
        )
        return done.stdout.split()

    return complete


def test_bash_completes_commands_options_and_what_is_shipped(completed):
    assert completed("stratawalk", "exp") == ["export"]
    assert completed("stratawalk", "run", "--seg") == ["--segments"]
    assert completed("stratawalk", "run", "li") == ["line"]
    assert completed("stratawalk", "run", "line", "--robot", "qua") == ["quadruped"]
    robots = completed("stratawalk", "identify", "hex")
    assert robots == [name for name in shipped_robots() if name.startswith("hex")]
    assert set(shipped_scenarios()) <= set(completed("stratawalk", "plan", "''"))


@pytest.mark.parametrize("shell", ["zsh", "tcsh"])
def test_other_shells_are_served(shell, capsys):
    assert main(["completion", shell]) == 0
    assert "stratawalk" in capsys.readouterr().out
