"""`stratawalk study`: classes, findings and maps of a table that is known."""

import json

import pytest
from PIL import Image

from sim.cli import main
from sim.errors import UsageError
from sim.studies.results import read_results
from sim.sweeps.file import read_sweep, shipped_studies
from sim.sweeps.table import write_table

ABOUT = {"asked": {"vary": {"friction": [], "play with draw": []}}, "software": {}}
FARTHEST = [0.0005, 0.002, 0.008, 0.5, 0.5, None]  # on a path of 0.1 m


@pytest.fixture
def folder(tmp_path):
    rows = [
        {
            "point": number,
            "friction": 0.2 * (number + 1),
            "play": 0.01 * (number % 2),
            "draw": number % 2,
            "status": "no plan: none" if farthest is None else "ok",
            "verdict": "fell" if number == 4 else "arrived",
            "path_length": 0.1,
            "distance_walked": 1.0,
            "error.quasi_static.farthest": farthest,
        }
        for number, farthest in enumerate(FARTHEST)
    ]
    write_table(tmp_path / "table.parquet", rows, ABOUT)
    return tmp_path


def test_points_are_sorted_by_how_well_the_prediction_holds(folder):
    results = read_results(folder, "quasi_static")
    assert results.keys == ("friction", "play", "draw")
    assert results.classes.tolist() == [0, 1, 2, 3, 4, 5]


def test_findings_and_maps_are_printed_and_drawn(folder, capsys):
    assert main(["study", str(folder), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["classes"] == {
        "within 1 %": 1, "within 3 %": 1, "within 10 %": 1, "beyond": 1, "fell": 1,
        "no walk": 1,
    }  # fmt: skip
    assert found["reasons"] == {"no plan: none": 1}
    assert len(found["maps"]) == 3
    for path in found["maps"]:
        with Image.open(path) as picture:
            assert len(picture.convert("RGB").getcolors(1 << 20)) > 6


def test_equal_tables_give_equal_bytes(folder, tmp_path):
    for name in ("one", "two"):
        main(["study", str(folder), "--out", str(tmp_path / name)])
    folders = (tmp_path / "one", tmp_path / "two")
    one, two = ({p.name: p.read_bytes() for p in f.iterdir()} for f in folders)
    assert one == two


def test_what_is_no_table_of_a_sweep_is_refused(tmp_path):
    (tmp_path / "table.parquet").write_bytes(b"PAR1")
    with pytest.raises(UsageError, match="not the table of a sweep"):
        read_results(tmp_path, "ideal")
    with pytest.raises(UsageError, match="no such table"):
        read_results(tmp_path / "none.parquet", "ideal")


@pytest.mark.parametrize("name", shipped_studies())
def test_every_point_of_a_shipped_study_is_possible(name):
    study = read_sweep(name)
    assert len(study) >= 12
    for point in range(len(study)):
        study.at(point)
