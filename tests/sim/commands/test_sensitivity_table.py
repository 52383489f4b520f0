"""Rows and picture of what changes of a robot do to a walk's end."""

from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.figure import Figure

from sim.commands import comparing
from sim.studies import sensitivities


def test_every_change_has_the_row_of_its_own_effect_at_the_end(monkeypatch):
    changes = [SimpleNamespace(what=name, unit="1 mm") for name in ("one", "other")]
    pose = np.array([[[1.0, 2.0, 3.0]], [[4.0, 5.0, 6.0]]])  # at a single moment
    found = SimpleNamespace(changes=changes, pose=pose)
    monkeypatch.setattr(sensitivities, "sensitivities_of", lambda run, robot: found)
    assert comparing.rows(None, None) == [
        {"what": "one", "unit": "1 mm", "x": 1.0, "y": 2.0, "yaw": 3.0},
        {"what": "other", "unit": "1 mm", "x": 4.0, "y": 5.0, "yaw": 6.0},
    ]


@pytest.mark.parametrize(("way", "scale"), [(0.003, 0.6 * 0.2 / 0.003), (0.0, 0.12)])
def test_the_longest_arrow_is_six_tenths_of_the_way_to_the_farthest_foot(
    way, scale, tmp_path, monkeypatch
):
    """And where nothing moves, no arrow has a length."""
    figures = []

    def savefig(figure, part, **_):
        figures.append(figure)
        part.touch()

    monkeypatch.setattr(Figure, "savefig", savefig)
    feet = np.array([[0.1, 0.05], [-0.2, 0.05]])
    achieved = np.array([[7.0, 8.0, 0.0]])
    run = SimpleNamespace(
        contact_point=(feet + [7.0, 8.0])[None], achieved=achieved, legs=(1, 2)
    )
    found = [
        {"what": "zero of leg 2", "unit": "1 degree", "x": way, "y": 0.0, "yaw": 0.0},
        {"what": "friction", "unit": "0.1", "x": 0.0, "y": way / 3, "yaw": 0.0},
    ]
    comparing.draw(run, found, tmp_path / "a.png")
    (axes,) = figures[0].axes
    assert f"drawn {scale:.3g} times as long" in axes.get_title()
    arrows = [text for text in axes.texts if text.arrow_patch]
    tips = sorted(tuple(np.subtract(text.xy, text.xyann)) for text in arrows)
    assert np.array(tips) == pytest.approx(
        np.array([(0, way * scale / 3), (way * scale, 0)]), abs=1e-12
    )
