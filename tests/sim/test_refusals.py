"""Files that are damaged are refused in words of our own, not in a library's."""

import re
import shutil

import pytest

from models import ModelError, load
from sim.cli import main
from sim.errors import UsageError, one_line
from sim.runs.run import read_run
from sim.studies.results import read_results

OF_LIBRARIES = r"Error|Expecting|zip|ufunc|thrift|magic|Could not|index out|loop with"


def test_a_refusal_without_advice_ends_with_its_place():
    refused = UsageError.at("the card", ValueError("it has no number"))
    assert str(refused) == "it has no number: the card"
    advised = UsageError.at("the card", ValueError("it has no number; give one"))
    assert str(advised) == "it has no number: the card; give one"


def test_a_refusal_is_one_line_with_its_place_as_it_is_called():
    found = one_line(UsageError("first\n  second\n\n", "two  blanks", "go\ton"))
    assert found == "first second : two  blanks; go\ton"


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("summary.json", "", "summary.json is no JSON, line 1"),
        ("summary.json", '{"a": 1,\n', "summary.json is no JSON, line 2"),
        ("summary.json", "[]", "summary.json holds no table"),
        ("trajectory.npz", "none", "trajectory.npz or commands.npz, are damaged"),
        ("flows.csv", "none", "flows.csv lists no phase"),
    ],
)
def test_a_damaged_file_of_a_run_is_named(walked, tmp_path, name, text, said):
    folder = shutil.copytree(walked, tmp_path / "run")
    (folder / name).write_text(text)
    with pytest.raises(UsageError, match=re.escape(said)) as refusal:
        read_run(folder)
    assert not re.search(OF_LIBRARIES, str(refusal.value))


def test_a_value_of_the_wrong_kind_is_refused_without_the_words_of_numpy(
    walked, tmp_path, capsys
):
    folder = shutil.copytree(walked, tmp_path / "run")
    summary = folder / "summary.json"
    text = re.sub(r'"achieved": \{\s*"pose": \[', '\\g<0>"x", ', summary.read_text())
    assert text != summary.read_text()
    summary.write_text(text)
    assert main(["show", str(folder)]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert not re.search(OF_LIBRARIES, line)


@pytest.mark.parametrize("content", [b"", b"garbage", b"PAR1" + bytes(99) + b"PAR1"])
def test_a_damaged_table_is_refused_as_one(tmp_path, content):
    (tmp_path / "table.parquet").write_bytes(content)
    with pytest.raises(UsageError, match="damaged, or no Parquet file") as refusal:
        read_results(tmp_path)
    assert not re.search(OF_LIBRARIES, str(refusal.value))


def test_an_empty_model_is_told_to_hold_no_xml(tmp_path):
    (tmp_path / "empty.xml").touch()
    (tmp_path / "empty.toml").touch()
    with pytest.raises(ModelError, match="there is no XML in it"):
        load(str(tmp_path / "empty.xml"))


def test_a_file_of_a_sweep_is_no_scenario_and_says_what_walks_it(tmp_path, capsys):
    file = tmp_path / "mine.toml"
    file.write_text('scenario = "line"\n[grid]\nfriction = [0.3, 0.6]\n')
    assert main(["run", str(file)]) == 2
    assert f"stratawalk sweep {file} --out sweeps/mine" in capsys.readouterr().err
