"""The closed forms of Sec. 6 against support polygons that know nothing of them."""

import numpy as np
import pytest
import shapely

from models.contact.kinematics import Kinematics
from models.contact.loads import PaperStance
from models.library import load
from sim.motion.stability import stability_margin, support_polygons

STANCE = PaperStance(body_length=0.3, leg_length=0.105, half_width=0.045)
ROUNDING = 1e-12
TRIPODS = (1, 2)


def grid(stance):
    """Angles and distances from the front, off the bounds by more than rounding."""
    phi, b = np.meshgrid(
        np.linspace(-1.4, 1.4, 141), np.linspace(-0.5, 1.5, 161) * stance.body_length
    )
    return phi.ravel(), b.ravel()


def polygon_margin(stance, tripod, phi, b):
    weight = np.stack([stance.body_length / 2 - b, np.zeros_like(b)], axis=-1)
    return stability_margin(
        stance.feet(tripod, phi), np.ones((phi.size, 3), bool), weight
    )


@pytest.mark.parametrize("tripod", TRIPODS)
@pytest.mark.parametrize(
    "stance", [STANCE, PaperStance(1.0, 1.0, 0.01), PaperStance(4.0, 1.0, 2.0)], ids=str
)
def test_closed_form_and_support_polygon_agree_in_sign_everywhere(stance, tripod):
    phi, b = grid(stance)
    closed = stance.margin_along_axis(phi, b)
    off = np.abs(closed) > ROUNDING
    assert off.sum() > 0.99 * off.size
    found = polygon_margin(stance, tripod, phi, b)
    assert np.array_equal(np.sign(found[off]), np.sign(closed[off]))


@pytest.mark.parametrize("tripod", TRIPODS)
def test_the_bounds_are_where_the_polygon_s_edge_crosses_the_body_s_axis(tripod):
    phi = np.linspace(-1.4, 1.4, 57)
    polygons = support_polygons(STANCE.feet(tripod, phi), np.ones((phi.size, 3), bool))
    axis = shapely.LineString([(-10, 0), (10, 0)])
    rear, _, front, _ = shapely.bounds(shapely.intersection(polygons, axis)).T
    low, high = STANCE.bounds(phi)
    assert STANCE.body_length / 2 - front == pytest.approx(low, abs=ROUNDING)
    assert STANCE.body_length / 2 - rear == pytest.approx(high, abs=ROUNDING)


@pytest.mark.parametrize("tripod", TRIPODS)
def test_inside_the_margin_is_the_closed_form_times_the_slope_of_the_sides(tripod):
    phi, b = grid(STANCE)
    closed = STANCE.margin_along_axis(phi, b)
    inside = closed > 0
    y = STANCE.half_width + STANCE.leg_length * np.cos(phi[inside])
    slope = 2 * y / np.hypot(STANCE.body_length / 2, 2 * y)
    expected = np.minimum(closed[inside] * slope, y)  # or the side along the axis
    found = polygon_margin(STANCE, tripod, phi[inside], b[inside])
    assert found == pytest.approx(expected, abs=ROUNDING)


def test_the_parallel_hexapod_is_the_paper_s_stance_as_a_body():
    robot = load("hexapod-parallel")
    phi = np.linspace(-0.4, 0.4, 9)
    found = Kinematics(robot).stance(np.stack([phi, phi], axis=-1)).feet
    for tripod in TRIPODS:
        on = robot.planted(str(tripod))
        assert found[:, on] == pytest.approx(STANCE.feet(tripod, phi), abs=1e-9)


@pytest.mark.parametrize("field", ["body_length", "leg_length", "half_width"])
def test_lengths_are_positive(field):
    lengths = {"body_length": 1.0, "leg_length": 1.0, "half_width": 1.0}
    with pytest.raises(ValueError, match=f"{field} must be positive, got 0"):
        PaperStance(**lengths | {field: 0})
