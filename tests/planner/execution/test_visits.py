"""Visits of strata that centring adds to a walk."""

from types import SimpleNamespace

from planner.execution.centring import _place, _Visit


def test_a_new_visit_is_made_where_it_adds_fewest_contact_switches():
    """On the way from 1 to 123; behind it, it would be a detour on the way to 3."""
    system = SimpleNamespace(switches=lambda one, other: len({*one} ^ {*other}))
    done, following = [_Visit("123", 4)], _Visit("3", 5)
    placed = _place(system, done, {"12": ("g", 1.0)}, (0, following), "1")
    assert [visit.stratum for visit in done] == ["12", "123"]
    assert placed is done[0]
