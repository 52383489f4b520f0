"""Systems for tests: the hexapod of Sec. 6, and small ones with known answers."""

import sympy as sp

from planner.lie.hall import hall_basis
from planner.systems.flows import Flow, visits
from planner.systems.strata import StratifiedSystem

X, Y, THETA = sp.symbols("x y theta")
PAPER = ("g12_1", "g12_2", "g1_2", "g2_1", "[g12_1,g12_2]")
LIFTED = ("g1_1", "g2_2", "g1_2", "g2_1", "[g1_1,g2_2]")
GAIT = ("12", "1", "12", "2", "12")
LIFTS = {"1": "g1_3", "2": "g2_3"}  # fields that raise a tripod, by stratum
METRES = {"stride": 0.0378, "yaw_gain": 0.56}  # of the robot that walks, [m/rad], [1]


def hexapod(stride=1, yaw_gain=1, *, heights=False):
    """Eqs. (16) to (18) with l split into stride and yaw gain."""
    names = "x y theta phi_1 phi_2" + " height_1 height_2" * heights
    state = sp.symbols(names)
    forward = [stride * sp.cos(THETA), stride * sp.sin(THETA)]

    def field(moved, *velocity):
        body = list(velocity) + [0] * (3 - len(velocity))
        return body + [int(str(s) == moved) for s in state[3:]]

    first = field("phi_1", *forward, yaw_gain)
    second = field("phi_2", *forward, -yaw_gain)
    strata = {
        "12": {"g12_1": first, "g12_2": second},
        "1": {"g1_1": first, "g1_2": field("phi_2")},
        "2": {"g2_1": field("phi_1"), "g2_2": second},
    }
    if not heights:
        return StratifiedSystem(state, strata, "12")
    strata["1"]["g1_3"] = field("height_2")
    strata["2"]["g2_3"] = field("height_1")
    h1, h2 = state[5:]
    return StratifiedSystem(state, strata, "12", {"12": [h1, h2], "1": [h1], "2": [h2]})


def with_lifts(flows, height, lifts):
    """Flows with the lift-off before and the touchdown after each visit, eq. (12).

    `lifts` names for each stratum the field that raises the foot in the air there.
    """
    complete = []
    for visit in visits(flows):
        stratum = visit[0].stratum
        if lift := lifts.get(stratum):
            visit = [Flow(stratum, lift, height), *visit, Flow(stratum, lift, -height)]
        complete += visit
    return complete


def hall_elements(names):
    """Elements of the Hall basis by their names."""
    named = {str(element): element for element in hall_basis(4, 5)}
    return tuple(named[name] for name in names)


def heisenberg():
    """Two fields that are nilpotent of order two."""
    state = sp.symbols("x y z")
    fields = {"g1": [1, 0, -state[1] / 2], "g2": [0, 1, state[0] / 2]}
    return StratifiedSystem(state, {"0": fields}, "0")


def chained(size):
    """A chained form: x1' = u1, x2' = u2, x3' = x2 u1, x4' = x3 u1, and so on."""
    state = sp.symbols(f"x1:{size + 1}")
    fields = {"g1": [1, 0, *state[1:-1]], "g2": [0, 1] + [0] * (size - 2)}
    return StratifiedSystem(state, {"0": fields}, "0")


def flat_power(power):
    """g1 = (1, 0) and g2 = (0, x^p), which at x = 0 need brackets of degree p + 1."""
    return StratifiedSystem((X, Y), {"0": {"g1": [1, 0], "g2": [0, X**power]}}, "0")
