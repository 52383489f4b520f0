from .dissipation import (
    foot_velocities as foot_velocities,
    least_dissipation_twist as least_dissipation_twist,
    viscous_twist as viscous_twist,
)
from .kinematics import (
    UPRIGHT as UPRIGHT,
    Stance as Stance,
    covering_core as covering_core,
    find_sole as find_sole,
)
from .loads import lift_torques as lift_torques, static_loads as static_loads
from .sliding import sliding_twist as sliding_twist
