"""What the optimiser is asked for, from a scenario."""

from dataclasses import replace

from sim.experiments.identification import twist_model
from sim.optimisation import judging
from sim.optimisation.judging import real_equations
from sim.preparation.setup import prepare


def test_settings_of_one_world_do_not_share_the_strokes_of_another_prediction(
    scenario, hexapod, monkeypatch
):
    asked = []

    def recorded(setup, prediction):
        asked.append(prediction)
        return twist_model(setup, "quasi_static")  # identifying takes seconds

    monkeypatch.setattr(judging, "twist_model", recorded)
    setup = prepare(scenario(steer="quasi-static"), hexapod)
    other = replace(setup, scenario=scenario(steer="identified"))
    assert setup == other
    for one in (setup, other, setup):
        real_equations(one)
    assert asked == ["quasi_static", "identified"]
