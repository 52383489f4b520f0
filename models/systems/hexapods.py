"""The hexapod of Sec. 6: its equations of motion (16) to (18) and its elements (19).

The state is x, y, theta, phi_1, phi_2, height_1, height_2: the body's pose, and the
swing angle and the foot height of each tripod. With all feet down, eq. (16), the
columns are

    g_{12,1} = (cos theta, sin theta,  l, 1, 0, 0, 0)    tripod 1 swings
    g_{12,2} = (cos theta, sin theta, -l, 0, 1, 0, 0)    tripod 2 swings

With tripod 2 in the air, eq. (17), it recovers without moving the body, and it lifts:

    g_{1,1} = (cos theta, sin theta, l, 1, 0, 0, 0)      tripod 1 swings
    g_{1,2} = (0, 0, 0, 0, 1, 0, 0)                      tripod 2 swings in the air
    g_{1,3} = (0, 0, 0, 0, 0, 0, 1)                      tripod 2 lifts

With tripod 1 in the air, eq. (18), it is the other way round:

    g_{2,1} = (0, 0, 0, 1, 0, 0, 0)                      tripod 1 swings in the air
    g_{2,2} = (cos theta, sin theta, -l, 0, 1, 0, 0)     tripod 2 swings
    g_{2,3} = (0, 0, 0, 0, 0, 1, 0)                      tripod 1 lifts

The elements of eq. (19) are the strokes of the bottom stratum, the swings in the air,
and the bracket that moves the body sideways. Here are the body twists of the groups on
the ground; `motion.equations_of_motion` makes the columns of them.
"""

from __future__ import annotations

from models.motion.equations_of_motion import Twist
from models.systems.legged import AIR_SWINGS, ALTERNATING, walker
from models.systems.problem import Problem


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
    first: Twist = (stride, 0, yaw_gain)
    turn = yaw_gain if yaw_gain_2 is None else yaw_gain_2
    second: Twist = (stride if stride_2 is None else stride_2, 0, -turn)
    down = {"12": {"1": first, "2": second}, "1": {"1": first}, "2": {"2": second}}
    return Problem(
        name="paper-hexapod",
        description="the paper's hexapod in tripods, sideways as in Fig. 6",
        system=walker({**down, "0": {}}, heights=heights),
        gait=ALTERNATING,
        elements=("g12_1", "g12_2", *AIR_SWINGS, "[g12_1,g12_2]"),
        goal={"x": 1, "y": 1},
        segments=16,
    )


def hexapod_with_trailer(length: float = 1, heights: bool = True) -> Problem:
    """The paper's hexapod with a trailer hitched to its middle; needs degree 3.

    Its axle is that far from the hitch, in the hexapod's units.
    """
    first: Twist = (1, 0, 1)
    second: Twist = (1, 0, -1)
    down = {"12": {"1": first, "2": second}, "1": {"1": first}, "2": {"2": second}}
    sideways = "[g1_1,g2_2]"
    return Problem(
        name="hexapod-trailer",
        description="the paper's hexapod with a trailer; degree 3, needs --replan",
        system=walker(down, heights=heights, trailer=length),
        gait=ALTERNATING,
        elements=("g1_1", "g2_2", *AIR_SWINGS, sideways, f"[g1_1,{sideways}]"),
        goal={"y": 0.1},
        segments=4,
    )
