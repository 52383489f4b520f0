"""The hexapod of Sec. 6, walkers of few feet in units of their own size, and fingers.

The state of the hexapod, eqs. (16) to (18), is x, y, theta, phi_1, phi_2, height_1,
height_2: the body's pose, and the swing angle and the foot height of each tripod. The
columns with all feet down, eq. (16), and with tripod 2 in the air, eq. (17), are

    g_{12,1} = (cos theta, sin theta,  l, 1, 0, 0, 0)    tripod 1 swings
    g_{12,2} = (cos theta, sin theta, -l, 0, 1, 0, 0)    tripod 2 swings
    g_{1,1} = (cos theta, sin theta, l, 1, 0, 0, 0)      tripod 1 swings
    g_{1,2} = (0, 0, 0, 0, 1, 0, 0)                      tripod 2 swings in the air
    g_{1,3} = (0, 0, 0, 0, 0, 0, 1)                      tripod 2 lifts

and with tripod 1 in the air, eq. (18), the other way round. Here are the body twists of
the groups on the ground; `motion.equations_of_motion` makes the columns of them.
"""

from collections.abc import Mapping, Sequence
from math import pi

import sympy as sp

from models.motion.equations_of_motion import Swing, Twist, walking_system
from models.systems.problem import Problem
from planner import StratifiedSystem


def paper_hexapod(
    stride: float = 1,
    yaw_gain: float = 1,
    stride_2: float | None = None,
    yaw_gain_2: float | None = None,
    heights: bool = True,
) -> Problem:
    """The minimalist hexapod of Sec. 6, steered with the paper's elements.

    Args:
        stride: Way forward per radian of tripod 1.
        yaw_gain: Turn to the left per radian of tripod 1, l in eq. (16).
        stride_2: Way forward per radian of tripod 2; that of tripod 1 if None.
        yaw_gain_2: Turn to the right per radian of tripod 2; that of tripod 1 if None.
        heights: Whether the state holds the tripods' foot heights.

    Example:
        >>> from models import paper_hexapod
        >>> paper_hexapod().elements
        ('g12_1', 'g12_2', 'g1_2', 'g2_1', '[g12_1,g12_2]')
    """
    turn = yaw_gain if yaw_gain_2 is None else yaw_gain_2
    second = stride if stride_2 is None else stride_2
    down = _tripods((stride, 0, yaw_gain), (second, 0, -turn))
    return Problem(
        name="paper-hexapod",
        description="the paper's hexapod in tripods, sideways as in Fig. 6",
        system=walker({**down, "0": {}}, heights=heights),
        gait=ALTERNATING,
        elements=("g12_1", "g12_2", *AIR_SWINGS, "[g12_1,g12_2]"),
        goal={"x": 1, "y": 1},
        segments=16,
    )


def _tripods(first: Twist, second: Twist) -> dict[str, dict[str, Twist]]:
    """Body twists of the groups in contact, on each stratum that has any."""
    return {"12": {"1": first, "2": second}, "1": {"1": first}, "2": {"2": second}}


def hexapod_with_trailer(length: float = 1, heights: bool = True) -> Problem:
    """The paper's hexapod with a trailer hitched to its middle; needs degree 3.

    Its axle is that far from the hitch, in the hexapod's units.
    """
    down, sideways = _tripods((1, 0, 1), (1, 0, -1)), "[g1_1,g2_2]"
    return Problem(
        name="hexapod-trailer",
        description="the paper's hexapod with a trailer; degree 3, needs --replan",
        system=walker(down, heights=heights, trailer=length),
        gait=ALTERNATING,
        elements=("g1_1", "g2_2", *AIR_SWINGS, sideways, f"[g1_1,{sideways}]"),
        goal={"y": 0.1},
        segments=4,
        hitches=(sp.Symbol("theta") - sp.Symbol("psi"),),
    )


ALTERNATING = ("12", "1", "12", "2", "12")
AIR_SWINGS = ("g1_2", "g2_1")  # of the group that is up
Strata = Mapping[str, Mapping[str, Twist | None]]
Feet = Mapping[str, Sequence[tuple[float, float]]]  # x, y of each group's feet


def biped(hip: float = 1, heights: bool = True) -> Problem:
    """Two feet that turn about the vertical under their hips, lifted in turn (Fig. 2).

    It walks as one moves a heavy cupboard, by turning the body about the foot that
    stands. With both feet down nothing can move: the bottom stratum has no field. Each
    hip is that far from the middle of the body; the state may hold foot heights.
    """
    turning: Strata = {"1": {"1": (hip, 0, 1)}, "2": {"2": (hip, 0, -1)}}
    return Problem(
        name="biped",
        description="two feet about which the body turns, moved sideways (Fig. 2)",
        system=walker({"12": {"1": None, "2": None}, **turning}, heights=heights),
        gait=ALTERNATING,
        elements=("g1_1", "g2_2", *AIR_SWINGS, "[g1_1,g2_2]"),
        goal={"y": 1},
        segments=16,
    )


def quadruped(length: float = 2, width: float = 1, heights: bool = True) -> Problem:
    """A crawl, one leg at a time in the air: four strata of three feet (Fig. 3).

    All legs push while all feet are down, those of one side against the other's to
    turn, and step forward one by one. Length and width are those between feet.
    """
    x, y = sp.sympify(length) / 2, sp.sympify(width) / 2
    feet = {"1": [(x, y)], "2": [(x, -y)], "3": [(-x, y)], "4": [(-x, -y)]}
    steps = {"1": "234", "2": "134", "3": "124", "4": "123"}
    return Problem(
        name="quadruped-crawl",
        description="one leg at a time in the air, four strata of three feet (Fig. 3)",
        system=walker(shared(feet, ("1234", *steps.values())), heights=heights),
        gait=("1234", *(s for step in steps.values() for s in (step, "1234"))),
        elements=(
            *(f"g1234_{leg}" for leg in feet),
            *(f"g{step}_{leg}" for leg, step in steps.items()),
            "[g1234_1,g1234_2]",
        ),
        goal={"x": 0.5, "y": 0.25},
        segments=16,
    )


def octopod(length: float = 3, width: float = 1, heights: bool = True) -> Problem:
    """Eight legs in two tetrapods whose left and right pairs swing apart.

    Pairs 1 (legs 1, 5) and 4 (legs 4, 8) stand against 2 (2, 6) and 3 (3, 7), odd legs
    on the left, numbered from the front. A tetrapod turns by pushing its two sides
    against each other, so even its bracket needs one stratum only. Length and width are
    those between the outermost feet.
    """
    x, y = sp.sympify(length) / 6, sp.sympify(width) / 2
    feet = {
        "1": [(3 * x, y), (-x, y)],
        "2": [(3 * x, -y), (-x, -y)],
        "3": [(x, y), (-3 * x, y)],
        "4": [(x, -y), (-3 * x, -y)],
    }
    return Problem(
        name="octopod-pairs",
        description="eight legs in two tetrapods, a bracket within one stratum",
        system=walker(shared(feet, ("1234", "14", "23")), heights=heights),
        gait=("1234", "14", "1234", "23", "1234"),
        elements=(
            *("g14_1", "g14_4", "[g14_1,g14_4]"),
            *("g23_1", "g14_2", "g14_3", "g23_4"),
        ),
        goal={"x": 0.5, "y": 0.25},
        segments=16,
    )


def shared(feet: Feet, strata: Sequence[str]) -> Strata:
    """Body twists where all feet in contact share the slip, as in viscous friction.

    Every foot of a group goes backward by one per radian of its swing. The body moves
    so that the squares of the slip velocities of the feet in contact add up to least.
    Strata are named by the groups in contact, the bottom one first.
    """

    def twist(stratum: str, group: str) -> Twist:
        planted = [(owner, x, y) for owner in stratum for x, y in feet[owner]]
        rows = [row for _, x, y in planted for row in ([1, 0, -y], [0, 1, x])]
        swung = [v for owner, *_ in planted for v in (int(owner == group), 0)]
        slip, swing = sp.Matrix(rows), sp.Matrix(swung)
        forward, left, yaw = (slip.T * slip).LUsolve(slip.T * swing)
        return forward, left, yaw

    return {name: {group: twist(name, group) for group in name} for name in strata}


def walker(
    strata: Strata, *, heights: bool = True, trailer: float | None = None
) -> StratifiedSystem:
    """The stratified system of a walker whose groups swing one by one.

    For each stratum, the bottom one first, the body twist that each group in contact
    gives when it swings; None if it cannot swing there. The bottom stratum has every
    group. Heights and trailer are those of `walking_system`.
    """
    groups = tuple(next(iter(strata.values())))
    swings = tuple(
        Swing(stratum, str(i), tuple(float(g == group) for g in groups), twist)
        for stratum, twists in strata.items()
        for i, group in enumerate(groups, start=1)
        if (twist := twists.get(group)) is not None or group not in twists
    )
    contacts = tuple((stratum, tuple(twists)) for stratum, twists in strata.items())
    return walking_system(groups, contacts, swings, heights=heights, trailer=trailer)


def finger_gaiting(fingers: int = 3, reach: float = 1, span: float = 0.5) -> Problem:
    """A disc on a pivot, turned by fingers that each swing along its rim and lift.

    It is the paper's extension to hands, with fingers on a disc for feet on the floor.
    The 2 to 9 fingers in contact turn with the disc and none of them slips, so all
    swing at the disc's rate over `reach`. One finger at a time is off the rim to swing
    back, by `span` to either side [rad].
    """
    if not 2 <= fingers <= 9:
        raise ValueError(f"fingers is {fingers}; 2 to 9 can walk around a disc")
    numbers = "123456789"[:fingers]
    names = ["disc", *(f"phi_{i}" for i in numbers), *(f"gap_{i}" for i in numbers)]
    steps = {numbers.replace(up, ""): up for up in numbers}

    def column(**rates: float) -> list[sp.Expr]:
        return [sp.sympify(rates.get(name, 0)) for name in names]

    strata = {
        s: {f"turn_{s}": column(disc=reach, **{f"phi_{i}": 1 for i in s})}
        for s in (numbers, *steps)
    }
    for s, up in steps.items():
        strata[s][f"swing_{s}"] = column(**{f"phi_{up}": 1})
        strata[s][f"lift_{s}"] = column(**{f"gap_{up}": 1})
    return Problem(
        name="finger-gaiting",
        description="a disc turned once around by fingers that swing and lift",
        system=StratifiedSystem(
            state=tuple(map(sp.Symbol, names)),
            strata=strata,
            bottom=numbers,
            level_sets={s: tuple(sp.Symbol(f"gap_{i}") for i in s) for s in strata},
        ),
        gait=(numbers, *(s for step in steps for s in (step, numbers))),
        elements=(f"turn_{numbers}", *(f"swing_{stratum}" for stratum in steps)),
        goal={"disc": 2 * pi},
        segments=8,
        limits={f"phi_{i}": (-span, span) for i in numbers},
        stance="centred",
    )
