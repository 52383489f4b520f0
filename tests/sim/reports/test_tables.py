"""The tables of a report say what the files of its run say."""

from sim.reports.tables import ends, kinds_of, settings
from sim.runs.run import read_run


def test_what_was_predicted_is_told_from_what_was_achieved(walked):
    run = read_run(walked)
    names = [name for name, *_ in ends(run).rows]
    predicted = [name for name in names if name.startswith("predicted, ")]
    assert len(predicted) == len(run.summary.predicted)
    assert {"goal", "achieved"} == {*names} - {*predicted}


def test_settings_stand_in_the_table_as_in_the_file(folder):
    file = folder / "scenario.toml"
    lines = file.read_text().splitlines()
    lines = [line for line in lines if not line.startswith("description")]
    file.write_text('description = "10 # 2 feet"\n' + "\n".join(lines))
    rows = {
        name: (value, about) for name, value, about in settings(read_run(folder)).rows
    }
    assert rows["description"][0] == '"10 # 2 feet"'
    assert rows["hold"][0] == str(read_run(folder).settings["hold"])
    assert rows["path.goal"][0] == "[0.03, 0.0, 0.0]"
    assert rows["slope"][0] == "not set"
    assert all(about for name, (_, about) in rows.items() if "." not in name)


def test_feet_that_are_no_whole_groups_stand_as_legs_in_the_sources():
    parts = dict.fromkeys(("swing Slegs 2 3", "land S12"))
    names = [name for name, _ in kinds_of(parts)][:2]
    assert names == ["swing on legs 2 3", "touchdown from S12"]
