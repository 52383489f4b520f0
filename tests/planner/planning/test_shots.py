"""How shots, aims and steps of a plan are cut, where it is known what they miss."""

from types import SimpleNamespace

import numpy as np
import pytest

from planner.errors import ConvergenceError, PlannerError, RangeError
from planner.execution.execution import Execution
from planner.planning import shooting
from planner.planning.paths import line
from planner.planning.shooting import FINEST, Shot, _aimed, plan_step, steer
from planner.systems.strata import StratifiedSystem

MOST_AIMS = 40  # a dozen suffice where aiming converges
STALLED = 10  # shots that must at least halve the distance together

PLAIN = StratifiedSystem(
    "x y", {"0": {"f": [1, 0], "g": [0, 1]}}, "0", metric={"x": 2.0}
)
EXTENDED = SimpleNamespace(system=PLAIN)
ORDER = Execution(coordinates="backward")


@pytest.fixture
def missing(monkeypatch):
    """Let shots end where a function of start and target says; the shots made."""
    made = []

    def use(end):
        def shot(extended, here, target, execution):
            made.append((here, target))
            return Shot(here, None, None, np.asarray(end(here, target), dtype=float))

        monkeypatch.setattr(shooting, "shot_towards", shot)
        monkeypatch.setattr(shooting, "_assembled", lambda *parts: parts)
        return made

    return use


def steered(goal=(8.0, 0.0), **changes):
    return steer(EXTENDED, (0.0, 0.0), goal, ORDER, **changes)


def test_a_shot_that_halves_the_distance_is_kept_and_one_that_does_not_is_halved(
    missing,
):
    """Of the way to its target a shot of up to 4 m misses a half."""

    def end(here, target):
        way = target - here
        return here + way * (0.5 if way[0] <= 4.0 else 0.49)

    made = missing(end)
    found = steered(tolerance=0.1)
    lengths = [float((target - here)[0]) for here, target in made]
    # shots of 8 m are too long, those of 4 m are not; the next may be as long as
    # before, but no longer than the way that is left
    assert lengths[:5] == [8.0, 4.0, 6.0, 3.0, 4.5]
    assert found.critical_step == pytest.approx(2 * 4.5)  # in the metric
    assert found.distances[:3] == pytest.approx((16.0, 12.0, 9.0))
    assert found.distances[-1] <= 0.1 < found.distances[-2]
    (_, shots, nominal, _) = found.plan
    assert len(shots) == len(found.distances) - 1
    assert nominal[:-1].tolist() == [shot.start.tolist() for shot in shots]
    assert nominal[-1].tolist() == [8.0, 0.0]


@pytest.mark.parametrize(("longest", "stalls"), [(2.0, False), (0.1, True)])
def test_shots_that_stall_are_aimed_in_pieces_instead(
    missing, monkeypatch, longest, stalls
):
    """Ten shots have to halve the distance together."""
    made = missing(lambda here, t: t if np.hypot(*(t - here)) <= longest else here)
    aimed, tried = [Shot(np.zeros(2), None, None, np.array([8.0, 0.0]))], []
    monkeypatch.setattr(shooting, "_aimed_pieces", lambda *_: tried.append(1) or aimed)
    found = steered()
    assert (len(tried) == 1) == stalls
    assert found.distances[-1] == 0.0
    kept = [b - a for a, b in made if np.hypot(*(b - a)) <= longest]
    assert (len(kept) == STALLED) == stalls
    if stalls:
        assert found.distances == (16.0, 0.0)  # of the pieces alone
        monkeypatch.setattr(shooting, "_aimed_pieces", lambda *_: tried.append(1))
        assert steered(max_shots=200).distances[-1] == 0.0
        assert len(tried) == 2  # once, as it was in vain


def test_a_shot_that_does_not_halve_any_distance_ends_in_an_error(missing, monkeypatch):
    made = missing(lambda here, target: here)
    monkeypatch.setattr(shooting, "_aimed_pieces", lambda *_: None)
    told = r"^0 shots end 16 from the goal, beyond the tolerance 1e-09; allow more, or "
    with pytest.raises(ConvergenceError, match=told):
        steered()
    lengths = [float((target - here)[0]) for here, target in made]
    assert lengths == [8.0 * 0.5**k for k in range(21)]
    assert FINEST == 0.5**20
    made.clear()
    aimed = [Shot(np.zeros(2), None, None, np.array([8.0, 0.0]))]
    monkeypatch.setattr(shooting, "_aimed_pieces", lambda *_: aimed)
    found = steered()
    assert found.distances == (16.0, 0.0)
    assert found.critical_step == pytest.approx(16.0 * FINEST)


@pytest.mark.parametrize(("most", "enough"), [(4, True), (3, False)])
def test_shots_are_as_many_as_allowed(missing, most, enough):
    missing(lambda here, target: here + 0.5 * (target - here))
    if enough:
        assert len(steered(tolerance=1.0, max_shots=most).distances) == 5
    else:
        with pytest.raises(ConvergenceError, match="^3 shots end 2 from the goal, bey"):
            steered(tolerance=1.0, max_shots=most)


def test_goals_are_met_to_a_billionth_within_a_hundred_shots_unless_it_is_said(missing):
    missing(lambda here, target: here + 0.6 * (target - here))
    away = 2.5**23 * 1.25e-9  # which 23 shots come so near to, and the next enough
    assert len(steered((away / 2, 0.0)).distances) == 1 + 24
    with pytest.raises(ConvergenceError, match="^100 shots end"):
        steered(tolerance=-1.0)  # which nothing meets


def test_pieces_are_tried_in_doubled_numbers_until_they_can_be_aimed(monkeypatch):
    tried = []

    def along(targets, extended, execution, tolerance):
        tried.append(len(targets) - 1)
        if len(tried) < 4:
            raise PlannerError("too long")
        return targets

    monkeypatch.setattr(shooting, "_aimed_along", along)
    way = line((0, 0), (8, 0))
    found = shooting._aimed_pieces(None, way, None, 1e-9)
    assert tried == [1, 2, 4, 8]
    assert found == pytest.approx(way.at(np.linspace(0, 1, 9)))
    tried[:] = []
    monkeypatch.setattr(shooting, "AIMED_PIECES", (1, 2))
    assert shooting._aimed_pieces(None, way, None, 1e-9) is None


def aimed(end, missing, target=(1.0, 2.0), tolerance=1e-9):
    made = missing(end)
    made.clear()
    found = _aimed(EXTENDED, np.zeros(2), np.array(target), ORDER, tolerance)
    return found, made


TURN = np.array([[0.9, 0.3], [-0.2, 0.8]])


def test_an_aim_is_corrected_until_its_shot_ends_at_the_target(missing):
    """As fast as Broyden's method, which a linear miss takes few steps of."""
    found, made = aimed(lambda here, target: TURN @ target, missing)
    assert found.end == pytest.approx([1.0, 2.0], abs=1e-9)
    assert len(made) <= 6
    curved, _ = aimed(lambda here, t: TURN @ t + 0.1 * np.sin(t[::-1]), missing)
    assert curved.end == pytest.approx([1.0, 2.0], abs=1e-9)


def test_an_aim_is_met_to_the_tolerance_in_the_metric(missing):
    off = np.array([0.4, 0.0])
    found, made = aimed(lambda here, target: target - off, missing, tolerance=0.8)
    assert len(made) == 1  # 0.4 m along x count twice
    _, made = aimed(lambda here, target: target - off, missing, tolerance=0.79)
    assert len(made) == 2
    assert made[1][1] == pytest.approx([1.4, 2.0])
    assert found is not None


def test_no_correction_is_longer_than_the_segment(missing):
    _, made = aimed(lambda here, target: target - [50.0, 0.0], missing)
    steps = [2 * (b - a)[0] for (_, a), (_, b) in zip(made, made[1:], strict=False)]
    assert max(steps) <= np.hypot(2.0, 2.0) * (1 + 1e-9)


def test_an_aim_that_does_not_matter_or_never_converges_is_given_up(missing):
    found, made = aimed(lambda here, target: np.zeros(2), missing)
    assert found is None
    assert len(made) == 2
    rng = np.random.default_rng(0)
    found, made = aimed(lambda here, target: rng.normal(size=2), missing)
    assert found is None
    assert len(made) == MOST_AIMS + 1


def range_error():
    return RangeError("phi", 2.0, -1.0, 1.0)


@pytest.mark.parametrize("limit", [1.0, 0.7, 0.001, 3e-6])
def test_a_step_goes_as_far_as_its_range_allows(monkeypatch, limit):
    tried = []

    def straight(extended, path, segments, execution, nodes):
        share = float(path(1.0)[0]) / 4.0
        tried.append(share)
        if share > limit:
            raise range_error()
        return share

    monkeypatch.setattr(shooting, "follow_path", straight)
    found = plan_step(None, (0.0, 1.0), (4.0, 1.0), ORDER)
    assert found.fraction == found.plan
    assert found.fraction <= limit
    assert limit - found.fraction <= max(2.0**-20, 1e-3 * found.fraction)
    assert tried[0] == 1.0
    assert (len(tried) == 1) == (limit == 1.0)


def test_a_step_of_which_nothing_is_possible_is_refused(monkeypatch):
    def straight(*_):
        raise range_error()

    monkeypatch.setattr(shooting, "follow_path", straight)
    with pytest.raises(RangeError):
        plan_step(None, (0.0, 1.0), (4.0, 1.0), ORDER)
