"""Servos of one make are found from a card that is far off, or are not told at all."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from scipy.linalg import expm

from sim.fitting.estimate import led, pooled
from sim.fitting.fitting import fit_servos, servos
from sim.fitting.makes import ALIKE, MAKE, OWN, SERVO, one_make, shared_make
from sim.fitting.servo_law import Commanded, _step

STEP, LASTING, JOINTS, NOISE = 0.008, 8.0, 3, np.radians(0.05)


def moving(truth, fastest, load=0.02):
    """Smooth motion of joints on servos of one make, and what was measured of it."""
    rng = np.random.default_rng(3)
    time = np.arange(0, LASTING, STEP)[:, None]
    pace, phase = rng.uniform(0.3, 1, JOINTS) * fastest, rng.uniform(0, 6, JOINTS)
    angle = 0.2 * np.minimum(time, 1) * np.sin(2 * np.pi * pace * time + phase)
    borne, inertia = load * np.cos(3 * time + phase), np.full(JOINTS, 0.002)
    log = Commanded(STEP, angle, borne, inertia, inertia)
    rows = np.arange(0, LASTING - 0.1, STEP)
    seen = log.answers(truth[None], rows)[0]
    return log, rows, seen + rng.normal(0, NOISE, seen.shape)


def make_of(stiffness, damping, band):
    truth = servos(np.full(JOINTS, stiffness), np.full(JOINTS, damping))
    truth[:, 2] = band * np.random.default_rng(1).uniform(size=JOINTS)
    truth[:, 4] = np.linspace(-0.01, 0.01, JOINTS)
    truth[:, 5] = 0.02
    return truth


@pytest.fixture(scope="module")
def cards():
    return servos(np.full(JOINTS, 1000.0), np.full(JOINTS, 2.8))


@pytest.mark.parametrize(("band", "fastest"), [(0.01, 2.2), (0, 0.5)])
def test_a_make_is_found_within_its_errors_from_a_card_that_is_far_off(
    cards, band, fastest
):
    truth = make_of(40.0, 0.78, band)
    log, rows, seen = moving(truth, fastest)
    each = fit_servos(log, rows, seen, cards)
    joints, make, own, whole = shared_make([(log, rows, seen)], cards, each)
    off = np.abs(make.value[0] - truth[0, MAKE])[ALIKE]
    assert (off < 3.5 * make.error[0, ALIKE]).all()
    assert make.error[0, 0] < 0.2  # of the logarithm, of which 1 was expected
    assert whole[:, 0] == pytest.approx(make.value[0, 0])
    apart = np.abs(own.value[:, 1] - truth[:, 4]) / own.error[:, 1]
    assert apart.max() < 4  # zeros, of which each joint has its own
    apart = np.abs(joints.value[:, 0] - np.log(40.0)) / joints.error[:, 0]
    assert apart.max() < 4
    alone, _, _ = one_make(each)  # around estimates of their own, which the card pulls
    assert alone.value[0, 0] - np.log(40.0) > 3.5 * alone.error[0, 0]


def test_stiffness_of_which_slow_motion_without_loads_tells_nothing_is_not_told(cards):
    log, rows, seen = moving(make_of(40.0, 0.78, 0.0), 0.5, load=0.0)
    each = fit_servos(log, rows, seen, cards)
    joints, make, *_ = shared_make([(log, rows, seen)], cards, each)
    assert not make.seen[0, 0]
    assert not joints.seen[:, 0].any()


@pytest.mark.parametrize(
    ("stiffness", "damping", "fastest"), [(30, 2, 0.5), (40, 1, 1)]
)
def test_joints_whose_own_servos_are_a_poorer_guess_reach_to_the_common_one(
    cards, stiffness, damping, fastest
):
    truth = make_of(stiffness, damping, 0.0)
    log, rows, seen = moving(truth, fastest, load=0.05)
    each = fit_servos(log, rows, seen, cards)
    joints, make, *_ = shared_make([(log, rows, seen)], cards, each)
    assert make.seen[0, 0]
    off = np.abs(each.value[:, 0] - np.log(stiffness))
    assert (off > 4 * each.error[:, 0]).any()
    assert (off < 4 * joints.error[:, 0]).all()


@pytest.mark.parametrize("fastest", [1.2, 2.2])
def test_errors_of_a_make_do_not_depend_on_the_steps_of_differences(cards, fastest):
    """Light legs hardly tell more stiffness from more damping: slopes nearly cancel."""
    truth = make_of(20.0, 0.6, 0.01)
    log, rows, seen = moving(truth, fastest, load=0.001)
    log, errors = replace(log, inertia=log.inertia / 8, leg=log.leg / 8), []
    for part in (1.0, 0.1):
        finer = tuple(replace(p, step=part * p.step) for p in SERVO)
        found = led(partial(log.answers, rows=rows), seen, finer, cards, truth, MAKE)
        errors.append(pooled(found, MAKE)[0].error[0, ALIKE])
    # 3 % measured; steps of 0.02 in logarithms made errors seven times too small
    assert errors[0] == pytest.approx(errors[1], rel=0.06)


@pytest.mark.parametrize("load", [0.02, 0.1])
def test_errors_of_dead_bands_reach_to_what_unlike_joints_tell_alone(load):
    """Stiffness and damping of a make differ by a twentieth from joint to joint."""
    truth = make_of(10.0, 0.1, 0.015)
    truth[:, 0] += [-0.05, 0, 0.05]
    truth[:, 1] += [0.05, -0.05, 0]
    near = servos(np.full(JOINTS, 9.0), np.full(JOINTS, 0.1))
    log, rows, seen = moving(truth, 2.2, load)
    each = fit_servos(log, rows, seen, near)
    _, _, own, _ = shared_make([(log, rows, seen)], near, each)
    # as the make has them alone, they missed by up to 20 of their standard errors
    assert (np.abs(own.value - truth[:, OWN]) < 3 * own.error).all()


@pytest.mark.parametrize("damping", [0.01, 19.9, 20.0, 20.1, 1e4])
@pytest.mark.parametrize("stiffness", [0.0, 100.0])
def test_a_step_of_the_law_is_the_exponential_of_its_matrix(stiffness, damping):
    """With hardly any damping, nearly and just as much as is critical, and far more."""
    found = _step(np.array([stiffness]), np.array([damping]), STEP)
    matrix = np.array([[0.0, 1.0], [-stiffness, -damping]])
    assert found[..., 0] == pytest.approx(expm(STEP * matrix), rel=1e-12, abs=1e-14)
