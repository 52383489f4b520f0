"""How records are made, kept and compared, wherever that is visible from outside."""

from dataclasses import fields
from importlib import import_module
from inspect import Parameter, signature

import pytest

SUMMARY = (
    "Departure", "PredictionError", "Predicted", "Weighed", "Accomplished", "Played",
    "Sensed", "Departed", "Real", "PerMetre", "Summary",
)  # fmt: skip
NAMED = [  # records of many numbers alike, which nobody could tell apart by their order
    *(("sim.evaluation.summary", name) for name in SUMMARY),
    ("models.description.servos", "JointServo"),
    ("models.morphology.mjcf", "Morphology"),
    ("models.systems.problem", "Problem"),
    ("planner.execution.execution", "Execution"),
    ("sim.feedback.sensing", "Sensing"),
    ("sim.fitting.estimate", "Parameter"),
    ("sim.scenarios.scenario", "Scenario"),
    ("sim.world.servos", "ServoSettings"),
]
MANY = [  # of which a plan, a walk or a sweep makes thousands
    ("planner.lie.hall", "Bracket"),
    ("planner.optimisation.stages", "Stage"),
    ("planner.optimisation.stages", "Recovery"),
    ("planner.optimisation.windows", "Window"),
    ("planner.systems.fields", "NumericField"),
    ("planner.systems.grouping", "Arrangement"),
    ("models.contact.kinematics", "Core"),
    ("models.contact.kinematics", "Stance"),
    ("models.motion.equations_of_motion", "Swing"),
    ("sim.motion.schedule", "LegState"),
    ("sim.motion.schedule", "Phase"),
    ("sim.physics.measure", "Readings"),
    ("sim.sweeps.ledger", "Outcome"),
    ("sim.sweeps.worker_pool", "Task"),
]
UNLIKE = [  # that hold what has no hash or no single truth, and are keys of caches
    ("models.systems.problem", "Problem"),
    ("planner.systems.closure", "LieClosure"),
    ("planner.extension.bracket_fields", "HallFields"),
    ("planner.extension.extended", "ExtendedSystem"),
    ("planner.extension.rectangles", "Rectangles"),
    ("planner.extension.steering", "Steering"),
    ("planner.lie.free_lie", "LieAlgebra"),
    ("planner.planning.chained_forms", "ChainedForm"),
    ("planner.planning.paths", "Path"),
    ("planner.planning.plane", "Plane"),
    ("planner.systems.flows", "Gait"),
    ("planner.systems.grouping", "Grouper"),
    ("planner.systems.level_sets", "LevelSet"),
    ("planner.systems.shape", "ShapeCoordinates"),
    ("planner.systems.strata", "StratifiedSystem"),
    ("sim.compliant.equilibrium", "Lanes"),
    ("sim.compliant.increment", "Mechanics"),
    ("sim.compliant.phases", "Phases"),
    ("sim.compliant.places", "Skeleton"),
    ("sim.export.source", "Source"),
    ("sim.feedback.stops", "Followed"),
    ("sim.fitting.poses", "PoseFit"),
    ("sim.logs.playing", "Motion"),
    ("sim.runs.run", "Run"),
    ("sim.simulation", "Prepared"),
    ("sim.simulation", "Simulation"),
]


def found(module, name):
    return getattr(import_module(module), name)


@pytest.mark.parametrize(("module", "name"), NAMED)
def test_records_of_many_numbers_are_made_by_their_names(module, name):
    made = found(module, name)
    kinds = {one.kind for one in signature(made).parameters.values()}
    assert kinds == {Parameter.KEYWORD_ONLY}
    with pytest.raises(TypeError, match="positional"):
        made(*[0.0] * len(fields(made)))


@pytest.mark.parametrize(("module", "name"), MANY)
def test_records_that_are_made_by_the_thousand_have_no_dictionary(module, name):
    assert not hasattr(object.__new__(found(module, name)), "__dict__")


@pytest.mark.parametrize(("module", "name"), UNLIKE)
def test_records_that_are_kept_in_caches_are_told_apart_by_identity(module, name):
    made = found(module, name)
    one, other = object.__new__(made), object.__new__(made)
    assert one != other
    assert len({one, other, one}) == 2


@pytest.mark.parametrize("name", SUMMARY)
def test_parts_of_a_summary_are_equal_to_the_tables_that_they_are_written_as(name):
    made = found("sim.evaluation.summary", name)
    part = made(**{one.name: "" for one in fields(made)})
    assert part == dict(part)
    assert dict(part) == {one.name: "" for one in fields(made)}
