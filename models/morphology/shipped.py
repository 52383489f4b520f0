"""The lengths and masses of the shipped robots, each with its source or derivation.

Data only. `python -m scripts.write_robots` writes the MJCF files beside this module
from it; a test keeps them equal.
"""

from dataclasses import replace
from math import sqrt

from models.morphology.dimensions import (
    Leg,
    Morphology,
    legs_on_a_circle,
    legs_towards_pivots,
)

# Hexapod: tripod 1 is legs 1, 4, 5 and tripod 2 is legs 2, 3, 6, as in Section 6. All
# six feet lie 0.1875 m from their tripod's pivot (a 3-4-5 triangle).
PIVOT = 0.0675  # R [m]
KAPPA = 0.56  # yaw gain [rad/rad]; stride = KAPPA * PIVOT = 0.0378 m/rad
FEET = {
    1: (0.15, 0.18),
    2: (0.15, -0.18),
    3: (0.0, 0.12),
    4: (0.0, -0.12),
    5: (-0.15, 0.18),
    6: (-0.15, -0.18),
}
PIVOTS = {leg: (0.0, PIVOT if leg in (1, 4, 5) else -PIVOT) for leg in FEET}

# A loaded leg may sag by 0.1 mm at the foot: the middle foot of a tripod carries 0.6 of
# 12.5 N on an arm of 0.105 m, and 7.5 N * (0.105 m)^2 / 0.1 mm = 830 N m/rad. What the
# walk departs from its quasi-static prediction falls as one over this stiffness.
STIFFNESS = 1000.0
# A 12-servo hobby robot's gear train: 300 : 1 on a coreless rotor of 2e-8 kg m^2.
ARMATURE = 300**2 * 2e-8
# Critical for armature and leg together (0.045 kg within 0.105 m adds a tenth to it).
DAMPING = 2 * sqrt(STIFFNESS * 1.1 * ARMATURE)

HEXAPOD = Morphology(
    name="hexapod",
    legs=legs_towards_pivots(FEET, PIVOTS, KAPPA),
    hip_height=0.06,
    plate=(0.085, 0.13, 0.008),
    body_mass=1.0,
    leg_mass=0.045,
    leg_radius=0.006,
    hip_radius=0.010,  # with the leg's radius under 18 mm: neighbours clear at 0.45 rad
    foot_radius=0.008,
    swing_range=0.45,
    lift_range=(-0.1, 0.6),
    stiffness=STIFFNESS,
    damping=DAMPING,
    armature=ARMATURE,
)

# The paper's Figs. 1 and 5 taken literally: legs square to the body.
HEXAPOD_PARALLEL = replace(
    HEXAPOD,
    name="hexapod-parallel",
    legs={
        leg: Leg(hip=(x, 0.045 * side), foot=(x, 0.15 * side))
        for leg, (x, side) in {
            1: (0.15, 1),
            2: (0.15, -1),
            3: (0.0, 1),
            4: (0.0, -1),
            5: (-0.15, 1),
            6: (-0.15, -1),
        }.items()
    },
    plate=(0.17, 0.06, 0.008),
)

# Educational hexapods carry six equal legs of two servos at 60 degrees on a round body.
# Radial legs can only turn it about its middle. Where it stands with the outer legs
# turned by 22 degrees, each tripod's lines meet at a pivot 0.05 m off the middle.
RADIAL_BEARINGS = {1: 30, 2: -30, 3: 90, 4: -90, 5: 150, 6: -150}  # [degrees]
RADIAL_PIVOTS = {leg: (0.0, -0.05 if leg in (1, 4, 5) else 0.05) for leg in FEET}

HEXAPOD_RADIAL = replace(
    HEXAPOD,
    name="hexapod-radial",
    legs=legs_on_a_circle(RADIAL_BEARINGS, 0.08, 0.11, RADIAL_PIVOTS),
    plate=(0.075, 0.075, 0.008),
)

# The table-top robot of classrooms: twelve MG90-class servos in printed parts, six
# equal radial legs on a round body, such as the Vorpal (vorpalrobotics.com/wiki).
# Masses: a servo weighs 13.4 g (data sheet of the MG90S), a cell 48.5 g (Panasonic
# NCR18650B); six swing servos and two cells are 177 g, the printed body and the
# electronics are taken as 123 g, the printed leg with its lift servo as 25 g. Sizes
# are not published: legs of 60 mm on hips 60 mm from the middle are taken, so that
# feet stand on a circle of 0.24 m.
# As such robots are sold, with legs straight out, they walk and turn and cannot step
# sideways. Here the horns are mounted turned, so that each tripod has a pivot: where
# its inner leg swings half as far as the outer ones, which keeps all of them on counts.
CLASSROOM_PIVOT = 0.044559963  # 0.0754 m from the inner foot, 0.1509 m from the others
CLASSROOM_PIVOTS = {
    leg: (0.0, -CLASSROOM_PIVOT if leg in (1, 4, 5) else CLASSROOM_PIVOT)
    for leg in FEET
}
CLASSROOM_STIFFNESS = 200.0  # of ideal servos; a leg sags by a thousandth of a radian
CLASSROOM_ARMATURE = 240**2 * 4e-9  # 30,000 rpm to 13 rad/s; a rotor of 7 mm

HEXAPOD_CLASSROOM = replace(
    HEXAPOD,
    name="hexapod-classroom",
    legs={
        number: Leg(hip=leg.hip, foot=leg.foot)
        for number, leg in legs_on_a_circle(
            RADIAL_BEARINGS, 0.06, 0.06, CLASSROOM_PIVOTS
        ).items()
    },
    hip_height=0.045,
    plate=(0.055, 0.055, 0.006),
    body_mass=0.30,
    leg_mass=0.025,
    leg_radius=0.004,
    foot_radius=0.007,
    stiffness=CLASSROOM_STIFFNESS,
    damping=2 * sqrt(CLASSROOM_STIFFNESS * 1.1 * CLASSROOM_ARMATURE),
    armature=CLASSROOM_ARMATURE,
)

# Two tetrapods, 1-4-6-7 and 2-3-5-8: the tripods with two inner legs each. All
# feet lie 0.2 m from their tetrapod's pivot.
OCTOPOD_FEET = {
    1: (0.16, 0.18),
    2: (0.16, -0.18),
    3: (0.05, sqrt(0.2**2 - 0.05**2) - 0.06),
    4: (0.05, 0.06 - sqrt(0.2**2 - 0.05**2)),
    5: (-0.05, sqrt(0.2**2 - 0.05**2) - 0.06),
    6: (-0.05, 0.06 - sqrt(0.2**2 - 0.05**2)),
    7: (-0.16, 0.18),
    8: (-0.16, -0.18),
}
OCTOPOD_PIVOTS = {
    leg: (0.0, 0.06 if leg in (1, 4, 6, 7) else -0.06) for leg in OCTOPOD_FEET
}

OCTOPOD = replace(
    HEXAPOD,
    name="octopod",
    legs=legs_towards_pivots(OCTOPOD_FEET, OCTOPOD_PIVOTS, KAPPA),
    body_mass=1.2,
    swing_range=0.4,
)

# In proportion like HAMR, the ambulatory micro-robot of swing-and-lift legs, at four
# times its length: four equal legs square to the body, farther out than apart. Its
# weight lies 15 mm behind the middle of its feet, not on the line between any two: a
# front leg can lift at any time, and a hind leg when a front one stands far back.
QUADRUPED = replace(
    HEXAPOD,
    name="quadruped",
    legs={
        leg: Leg(hip=(x, 0.02 * side), foot=(x, 0.12 * side))
        for leg, (x, side) in {
            1: (0.08, 1),
            2: (0.08, -1),
            3: (-0.05, 1),
            4: (-0.05, -1),
        }.items()
    },
    hip_height=0.05,
    plate=(0.09, 0.025, 0.008),
    body_mass=0.6,
    leg_mass=0.03,
    swing_range=0.55,
)

MORPHOLOGIES = (
    HEXAPOD,
    HEXAPOD_PARALLEL,
    HEXAPOD_RADIAL,
    HEXAPOD_CLASSROOM,
    OCTOPOD,
    QUADRUPED,
)
