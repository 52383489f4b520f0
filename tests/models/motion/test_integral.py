"""Integrals over panels: Gauss's precision, and polynomials in between."""

import numpy as np
import pytest

from models.motion.strokes import FRACTIONS, Integral

PANEL_NODES = 4  # exact for integrands of degree 7 over a panel

EDGES = np.array([0.0, 0.5, 1.0, 2.5])


def integral_of(function, edges=EDGES):
    lengths = np.diff(edges)[:, None]
    nodes = edges[:-1, None] + lengths * FRACTIONS
    return Integral(edges, (function(nodes) * lengths)[..., None])


@pytest.mark.parametrize("degree", range(PANEL_NODES))
def test_polynomials_below_the_number_of_nodes_are_exact_at_any_moment(degree):
    clock = np.linspace(0, 2.5, 23)
    found = integral_of(lambda t: t**degree)(clock)[:, 0]
    assert found == pytest.approx(clock ** (degree + 1) / (degree + 1), abs=1e-13)


@pytest.mark.parametrize("degree", range(2 * PANEL_NODES))
def test_whole_panels_are_exact_to_twice_the_degree(degree):
    found = integral_of(lambda t: t**degree)
    assert found.total[0] == pytest.approx(2.5 ** (degree + 1) / (degree + 1))


def test_integral_at_the_nodes_is_the_integral_at_their_moments():
    cosine = integral_of(np.cos)
    nodes = EDGES[:-1, None] + np.diff(EDGES)[:, None] * FRACTIONS
    assert cosine.at_nodes()[..., 0] == pytest.approx(
        cosine(nodes.ravel()).reshape(3, -1)
    )


def test_moments_beyond_the_ends_count_as_the_ends():
    cosine = integral_of(np.cos)
    assert cosine(np.array([-1.0, 9.0]))[:, 0] == pytest.approx([0.0, cosine.total[0]])


def test_no_panels_integrate_to_zero():
    nothing = Integral(np.zeros(1), np.zeros((0, PANEL_NODES, 2)))
    assert (nothing(np.array([0.0, 1.0])) == 0).all()
    assert (nothing.total == 0).all()
