"""`stratawalk study`: classes, findings and maps of a table that is known."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image
from pyarrow import parquet

from sim.cli import main
from sim.errors import UsageError
from sim.scenarios.file import scenario_table
from sim.studies import maps
from sim.studies.findings import findings
from sim.studies.maps import _place
from sim.studies.results import Results, read_results
from sim.sweeps import folder as sweep_folder
from sim.sweeps.file import read_sweep, shipped_studies
from sim.sweeps.table import write_table

ASKED = {
    "vary": {"friction": [], "play with draw": []},
    "scenario": scenario_table("line")[0],
    "set": {},
}  # fmt: skip
ABOUT = {"asked": ASKED, "software": {}}
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
            "verdict": (*["arrived"] * 4, "fell", None)[number],
            "path_length": 0.1,
            "distance_walked": 1.0,
            "error.quasi_static.farthest": farthest,
        }
        for number, farthest in enumerate(FARTHEST)
    ]
    write_table(tmp_path / "table.parquet", rows, ABOUT)
    return tmp_path


def test_a_table_in_which_points_of_other_software_are_mixed_says_so(folder):
    method, table = findings(read_results(folder)).method, folder / "table.parquet"
    write_table(table, parquet.read_table(table).to_pylist(), ABOUT | {"mixed": True})
    said = "; points of other sweeps or software are among these (--force-mix)"
    assert findings(read_results(folder)).method == method + said


def test_a_table_of_searches_that_were_cut_short_says_so(folder):
    results = read_results(folder)
    for hurried in ([True, False, True, None], [False] * 4):
        columns = {**results.columns, "hurried": hurried}
        method = findings(replace(results, columns=columns)).method
        said = "searches for plans were cut short at 2 points (column hurried)"
        assert (said in method) == any(hurried)


def test_points_are_sorted_by_how_well_the_prediction_holds(folder):
    results = read_results(folder, "quasi_static")
    assert results.keys == ("friction", "play", "draw")
    assert results.classes.tolist() == [0, 1, 2, 3, 4, 5]


def test_reasons_that_differ_in_numbers_alone_are_counted_together(folder):
    results = read_results(folder, "quasi_static")
    why = "no plan: phi_1 would reach {}, outside its range -0.45 to 0.45"
    said = [*map(why.format, (1.45, "-1.2e-05")), "phi_2 is 3", "take ax-12"]
    columns = {**results.columns, "status": [*said, "ok", "ok"]}
    assert findings(replace(results, columns=columns)).reasons == {
        "no plan: phi_1 would reach ..., outside its range ... to ...": 2,
        "phi_2 is ...": 1,
        "take ax-12": 1,  # a name
    }


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


def test_maps_are_drawn_behind_no_link_that_nobody_named(folder, tmp_path, capsys):
    """A stranger's folder, whose `maps` leads to one's own pictures."""
    home = tmp_path / "home"
    home.mkdir()
    (folder / "maps").symlink_to(home)
    assert main(["study", str(folder)]) == 2
    assert "is a link, which may lead anywhere: " in capsys.readouterr().err
    assert not [*home.iterdir()]
    assert main(["study", str(folder), "--out", str(folder / "maps")]) == 0


def test_maps_of_another_table_are_kept_in_a_folder_that_is_named(folder, capsys):
    (there := folder / "pictures").mkdir()
    for name in ("friction-play.png", "play-draw.png"):  # the first and the last
        (other := there / name).write_bytes(b"mine")
        assert main(["study", str(folder), "--out", str(there)]) == 2
        assert (
            f"already exists: {other}; give --out another name"
            in capsys.readouterr().err
        )
        assert other.read_bytes() == b"mine"
        assert [*there.iterdir()] == [other]
        other.unlink()


def test_maps_that_are_ended_early_in_a_folder_that_is_named_can_be_begun_again(
    folder, monkeypatch
):
    def ended(*_):
        raise KeyboardInterrupt

    there, drawn = folder / "pictures", maps._draw_map
    tried = iter([drawn, drawn, ended])
    monkeypatch.setattr(maps, "_draw_map", lambda *given: next(tried)(*given))
    assert main(["study", str(folder), "--out", str(there)]) == 130
    assert [*there.iterdir()] == []
    monkeypatch.setattr(maps, "_draw_map", drawn)
    assert main(["study", str(folder), "--out", str(there)]) == 0


def test_pairs_of_settings_of_which_no_map_is_drawn_are_counted(
    folder, capsys, monkeypatch
):
    monkeypatch.setattr(maps, "MOST_MAPS", 3)
    assert main(["study", str(folder)]) == 0
    assert "have no map" not in capsys.readouterr().err
    monkeypatch.setattr(maps, "MOST_MAPS", 2)
    assert main(["study", str(folder)]) == 0
    said = capsys.readouterr()
    assert said.out.count("\nmap ") == 2
    assert "pairs of settings that vary and have no map: 1" in said.err


def test_the_page_fits_its_classes_and_links_the_worst_and_the_best(
    folder, tmp_path, monkeypatch
):
    monkeypatch.setattr(maps, "EXTREMES", 1)
    monkeypatch.setattr(sweep_folder, "read_run", lambda _: True)  # nothing walked
    kept = folder / "runs" / "point-00004"
    varied = {"friction": 0.2 * 5, "play": 0.0, "draw": 0}
    for run, known in ((kept, varied), (folder / "runs" / "point-00000", {"play": 1})):
        run.mkdir(parents=True)
        (run / "report.html").touch()
        (run / "point.json").write_text(json.dumps({"of": "", "varied": known}))
    out = tmp_path / "pages" / "study.html"
    assert main(["study", str(folder), "--out", str(out), "--json"]) == 0
    page = out.read_text()
    assert page.count("<svg") == 3
    (link,) = re.findall('<a href="([^"]*)">report</a>', page)  # the other is not it
    assert (out.parent / link).resolve() == kept / "report.html"
    assert "<code>stratawalk run line</code> <code>--set " in page  # breaks between
    assert page.index("The worst walks") < page.rindex("500 %") < page.index("The best")


def test_the_page_has_the_classes_of_the_terminal_and_the_verdicts(
    folder, tmp_path, capsys
):
    assert main(["study", str(folder)]) == 0
    shown = capsys.readouterr().out.splitlines()[:8]
    assert "verdicts: arrived 4, fell 1" in shown
    out = tmp_path / "study.html"
    assert main(["study", str(folder), "--out", str(out)]) == 0
    assert capsys.readouterr().out.splitlines()[:8] == shown
    page = out.read_text()
    assert main(["study", str(folder), "--out", str(out)]) == 2
    assert f"already exists: {out}; give another name" in capsys.readouterr().err
    assert "Verdicts: arrived 4, fell 1." in page
    assert "<td>within 1 %</td><td>1</td>" in page
    assert page.count("<td>arrived</td>") == 4


def test_one_setting_alone_is_drawn_with_all_its_points(folder, tmp_path, capsys):
    rows = parquet.read_table(folder / "table.parquet").to_pylist()
    about = ABOUT | {"asked": ASKED | {"vary": {"friction": []}}}
    write_table(folder / "table.parquet", rows[:5], about)
    out = tmp_path / "study.html"
    assert main(["study", str(folder), "--out", str(out)]) == 0
    assert "nothing to divide" in capsys.readouterr().out
    page = out.read_text()
    used, there = (set(re.findall(p, page)) for p in ('href="#([^"]*)', ' id="([^"]*)'))
    assert any(name.startswith("C0_") for name in used)
    assert used <= there
    assert "friction varies." in page
    assert "The best walks" not in page


def test_a_file_that_is_no_page_is_refused(folder, tmp_path, capsys):
    out = tmp_path / "study.csv"
    assert main(["study", str(folder), "--out", str(out)]) == 2
    assert f"neither folder nor page: {out}; end it with .html" in (
        capsys.readouterr().err
    )
    assert not out.exists()


@pytest.mark.parametrize(
    ("shares", "limits"),
    [
        ([0.001, 0.0021, 0.003, 0.0041, 0.0049], (0.0025, 0.004, 0.005)),
        ([0.002] * 9, (0.002, 0.0025, 0.003)),  # which differ in any case
        ([0.0] * 3, (1e-9, 1.2e-9, 1.5e-9)),
    ],
)
def test_fitted_classes_divide_the_points_in_thirds_at_round_numbers(
    folder, shares, limits
):
    count = len(shares)
    columns = {
        "point": [*range(count)], "status": ["ok"] * count,
        "path_length": [1.0] * count, "distance_walked": [1.0] * count,
        "error.ideal.farthest": shares, "verdict": [None] * count,
    }  # fmt: skip
    fitted = Results(columns, (), "ideal").fitted()
    assert fitted.limits == pytest.approx(limits)
    assert sum([*fitted.counts.values()][:3]) == count  # and nothing is beyond


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


def test_a_folder_of_runs_is_told_which_two_can_be_compared(tmp_path):
    for name, file in (("a", "summary"), ("b", "summary"), ("c", "scenario")):
        (tmp_path / name).mkdir()
        (tmp_path / name / f"{file}.json").touch()
    with pytest.raises(UsageError) as refusal:
        read_results(tmp_path, "ideal")
    two = f"{tmp_path / 'a'} {tmp_path / 'b'}"
    assert refusal.value.remedy == f"runs are compared: stratawalk compare {two}"
    (tmp_path / "b" / "summary.json").unlink()  # a single one is compared with nothing
    with pytest.raises(UsageError, match="no such table.*; make one: stratawalk sweep"):
        read_results(tmp_path, "ideal")


def test_a_prediction_that_was_left_out_is_refused_with_those_that_were_made(folder):
    with pytest.raises(UsageError, match="not compared with the compliant") as refusal:
        read_results(folder, "compliant")
    assert refusal.value.remedy == "give --prediction quasi-static"
    read_results(folder, "quasi_static")


@pytest.mark.parametrize("name", shipped_studies())
def test_every_point_of_a_shipped_study_is_possible(name):
    study = read_sweep(name)
    assert len(study) >= 12
    for point in range(len(study)):
        study.at(point)


@pytest.mark.parametrize(("most", "scale"), [(0.18, "linear"), (0.22, "log")])
def test_an_axis_over_more_than_a_factor_of_20_is_logarithmic(most, scale):
    values = np.linspace(0.01, most, 15).tolist()
    axes = Figure().subplots()
    assert _place(
        axes, Results({"friction": values}, (), "ideal"), "friction", "x"
    ) == (pytest.approx(values))
    assert axes.get_xscale() == scale


def test_a_prediction_that_could_be_made_for_no_walk_is_refused(tmp_path):
    columns = {"point": 0, "status": "ok", "error.ideal.farthest": None, "a": 1.0}
    columns |= {"path_length": 2.0, "distance_walked": 2.0, "verdict": "arrived"}
    asked = {"asked": {"vary": {"a": {}}}}
    write_table(tmp_path / "t.parquet", [columns], asked)
    with pytest.raises(UsageError, match="could be made for none of the walks: .*give"):
        read_results(tmp_path / "t.parquet", "ideal")
