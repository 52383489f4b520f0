"""plan on cars with trailers, which turn farther than one chart serves."""

import json

import pytest

from sim import cli

CORNER = ("x=1", "y=1", "theta_0=1.5707963", "theta_1=1.5707963")


def test_a_trailer_is_brought_around_a_corner_and_the_plan_is_read_again(
    tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    ends = []
    corner = ("car-trailers", "--goal", *CORNER, "--save", "corner.json")
    for words in (corner, ("corner.json",)):
        assert cli.main(["plan", *words, "--json"]) == 0
        planned = json.loads(capsys.readouterr().out)
        assert planned["error"] < 1e-9
        ends.append(planned["end"])
    assert ends[1] == pytest.approx(ends[0], abs=1e-12)
