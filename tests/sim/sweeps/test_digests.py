"""A point is its settings and everything that its robot is made of."""

from sim.sweeps.ledger import digest


def test_a_point_is_another_one_if_a_file_that_its_model_includes_changes(
    edited, scenario
):
    robot = edited()
    point = scenario(robot=str(robot.path))
    before = digest(point, ())
    assert digest(point, ()) == before
    scene = robot.path.parent / "scene.xml"
    scene.write_text(scene.read_text().replace("<worldbody>", "<worldbody> "))
    assert digest(point, ()) != before


def test_names_make_no_other_point(scenario):
    assert digest(scenario(name="a"), ()) == digest(scenario(name="b"), ())
    assert digest(scenario(), ()) != digest(scenario(), ("identified",))


def test_a_point_is_another_one_if_the_motion_that_it_plays_changes(scenario, tmp_path):
    log = tmp_path / "log.csv"
    log.write_text("time,swing_1\n0,0\n1,0.1\n")
    point = scenario(motion=str(log))
    before = digest(point, ())
    log.write_text("time,swing_1\n0,0\n1,0.11\n")
    assert digest(point, ()) != before
