"""How problems are solved and what is tried, on problems whose answers are known."""

import math
from types import SimpleNamespace

import pytest

from planner import BoundError, BudgetError, PlannerError, RangeError
from sim.errors import SimulationError
from sim.problems import problem as module
from sim.problems.problem import NO_SHORTER, Problem, Solution, Trials, tried

FAR_OFF = 0.05  # of the way; where a plan ends farther off, changes are tried


class Known(Problem):
    """A problem whose plans are words, and their worths and misses numbers."""

    def __init__(self, **given):
        self.objective, self.replan, self.words = "time", False, "printed"
        self.segments, self.plan_time = 5, 60.0
        self.extended = SimpleNamespace(steering=SimpleNamespace(degree=3))
        self.best, self.short, self.refused = "stratified", "short", ()
        self.worths, self.off, self.tried = {"stratified": 2.0, "short": 1.0}, 0.2, []
        self.fallback = True
        vars(self).update(given)

    @property
    def stratified(self):
        """The stratified plan."""
        return self.best

    @property
    def has_fallback(self):
        """Whether it will do."""
        return self.fallback

    def check(self, plan):
        """Refuse some plans."""
        if plan in self.refused:
            raise SimulationError(f"{plan} falls", "t = 1 s", "walk slower")

    def shortest(self):
        """The short plan, or its error."""
        if isinstance(self.short, Exception):
            raise self.short
        return self.short

    def worth(self, plan):
        """As it is known."""
        return self.worths[plan]

    def miss(self, plan):
        """As it is known."""
        return self.off

    def changed(self, degree=0, **options):
        """Note what is changed."""
        self.tried.append((degree, options))
        return self

    def attempt(self, share=1.0):
        """Note a part of the way."""
        if share != 1:
            self.tried.append(share)
        return 1.0


def test_without_an_objective_the_stratified_plan_is_checked_and_taken():
    assert Known(objective="none").solve() == Solution("stratified")
    with pytest.raises(SimulationError, match="stratified falls"):
        Known(objective="none", refused=("stratified",)).solve()


@pytest.mark.parametrize(
    ("worths", "found"),
    [((2.0, 1.0), Solution("short")), ((2.0, 2.0), Solution("stratified", NO_SHORTER)),
     ((1.0, 2.0), Solution("stratified", NO_SHORTER))],
)  # fmt: skip
def test_a_shorter_plan_is_taken_if_it_is_shorter(worths, found):
    numbers = dict(zip(("stratified", "short"), worths, strict=True))
    assert Known(worths=numbers).solve() == found


@pytest.mark.parametrize("error", [BoundError("too narrow"), BudgetError(2.0, "")])
def test_where_no_shorter_plan_is_found_the_stratified_one_says_why(error):
    assert Known(short=error).solve() == Solution("stratified", str(error))
    with pytest.raises(type(error)):
        Known(short=error, fallback=False).solve()
    refused = Known(refused=("short",)).solve()
    assert refused.plan == "stratified"
    assert "the shortest plan found is refused: short falls" in refused.fallback
    assert Known(fallback=False, worths={}).solve() == Solution("short")


@pytest.mark.parametrize(("miss", "helped"), [(FAR_OFF, False), (0.051, True)])
def test_a_plan_that_ends_a_twentieth_off_is_helped(miss, helped):
    made = Known(off=miss)
    assert bool(made.helps("stratified")) == helped
    assert bool(made.tried) == helped


def test_what_cannot_help_is_said_instead():
    made = Known(reason=lambda: "it cannot turn")
    assert made.helps("stratified") == "it cannot turn"
    assert made.tried == []


@pytest.mark.parametrize("replan", [False, True])
@pytest.mark.parametrize("words", ["printed", "shortest"])
def test_remedies_are_words_degree_segments_replanning_and_half_of_the_way(
    replan, words
):
    made = Known(replan=replan, words=words)
    said = made.helps("stratified")
    names = ["--words symmetric"] * (words == "printed")
    names += ["--degree 4", "--segments 20", "--segments 80"]
    names += ["--replan", "half of the way"] * (not replan)
    assert said == f"nothing that was tried: {', '.join(names)}"
    changes = [*[(0, {"words": "symmetric"})] * (words == "printed"), (4, {}),
               (0, {"segments": 20}), (0, {"segments": 80})]  # fmt: skip
    assert made.tried == [*changes, *[(0, {"replan": True}), 0.5] * (not replan)]


def test_a_refusal_ends_with_what_helps():
    made = Known()
    found = made.refusal(RangeError("phi", 1.0, -0.5, 0.5))
    assert isinstance(found, PlannerError)
    assert "; what helps: --words symmetric ends 1e+02 % off" in str(found)


def offers(**misses):
    """Offers that end off by numbers, or raise."""

    def attempt(value):
        def now():
            if isinstance(value, Exception):
                raise value
            return value

        return now

    return [(name, attempt(value)) for name, value in misses.items()]


def test_changes_help_that_leave_half_of_what_is_missed():
    found = tried(offers(a=0.1, b=0.101, c=0.0, d=0.2), 0.2, 30.0)
    assert list(found.helpful) == ["c", "a"]
    assert found.useless == ("b", "d")
    plain = tried(offers(a=5.0, b=math.inf), math.inf, 30.0)
    assert plain.helpful == {"a": 5.0}
    assert plain.useless == ("b",)


def test_changes_without_a_plan_are_useless_and_time_that_is_up_ends_all():
    raising = offers(
        a=PlannerError("no"), b=ValueError("no"), c=SimulationError("no", "x", "y")
    )
    assert tried(raising, 1.0, 30.0).useless == ("a", "b", "c")
    cut = tried(offers(a=0.1, b=BudgetError(2.0, ""), c=0.1), 1.0, 30.0)
    assert list(cut.helpful) == ["a"]
    assert cut.useless == ()


def test_three_changes_that_end_near_are_enough():
    near = offers(a=0.05, b=0.051, c=0.01, d=0.02, e=0.001)
    found = tried(near, 1.0, 30.0)
    assert set(found.helpful) == {"a", "b", "c", "d"}
    assert str(found) == "c ends 1 % off; d ends 2 % off; a ends 5 % off"


@pytest.mark.parametrize(("seconds", "most"), [(5.0, 5), (100.0, 30)])
def test_trying_lasts_as_long_as_planning_and_half_a_minute_at_most(
    monkeypatch, seconds, most
):
    clock = iter(range(1000))
    monkeypatch.setattr(module.time, "monotonic", lambda: float(next(clock)))
    lefts = []

    class Limit:
        def __init__(self, left):
            lefts.append(left)

        def __enter__(self):
            return self

        def __exit__(self, *error):
            return False

    monkeypatch.setattr(module, "limited", Limit)
    tried([(str(k), lambda: 1.0) for k in range(100)], 1.0, seconds)
    assert lefts == [float(left) for left in range(most - 1, 0, -1)]


def test_of_no_trials_in_time_that_is_said():
    assert str(Trials({}, ())) == "nothing could be tried in time"
    assert tried(offers(a=0.1), 1.0, 0.0) == Trials({}, ())
