"""Numbers of options that no robot has are taken for mistakes."""

import argparse

import pytest

from sim.cli import main
from sim.commands.declared import real, whole


@pytest.mark.parametrize(
    ("text", "taken"), [("1e-6", True), ("0.9e-6", False), ("1e9", True),
                        ("1.1e9", False), ("0", False), ("-1", False),
                        ("1_0", False), ("١٢", False)],
)  # fmt: skip
def test_numbers_are_from_a_millionth_to_a_billion(text, taken):
    if taken:
        assert real(text, "a length", 0.1) == float(text)
    else:
        with pytest.raises(argparse.ArgumentTypeError, match="is not a length; give"):
            real(text, "a length", 0.1)
    if text == "0":
        assert real(text, "a length", 0.1, zero=True) == 0.0


def test_whole_numbers_are_counted_from_zero():
    assert whole("0") == 0
    for text in ("-1", "1_0", "١٢", "0x10"):
        with pytest.raises(argparse.ArgumentTypeError, match="0 or more"):
            whole(text)


def test_a_system_that_takes_too_long_is_refused(tmp_path, monkeypatch, capsys):
    """SymPy seeks the rank of such level sets for minutes."""
    n = range(9)
    sums = ("+".join(f"sin(x{i}*x{(i + j) % 9})*x{i}" for i in n) for j in n[1:])
    fields = [f"f{i} = {{ x{i} = 1 }}" for i in n]
    text = [f"state = {[f'x{i}' for i in n]}", "goal = { x0 = 1 }", "[strata.S]"]
    sets = [*fields, "[strata.B]", "g = { x0 = 1 }", "[level_sets]", f"B = {[*sums]}"]
    (tmp_path / "slow.toml").write_text("\n".join([*text, *sets]))
    monkeypatch.setattr("sim.commands.systems.READING_TIME", 0.5)
    for command in ("check", "plan"):
        assert main([command, str(tmp_path / "slow.toml")]) == 2
        said = "slow.toml; its formulas were not read within 0.5 s of processor time"
        assert said in capsys.readouterr().err
