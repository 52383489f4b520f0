"""Robots as other people write them: hexapods in three styles of MJCF, and any size.

Each function writes a robot into a folder and returns the path of its MJCF.
"""

from dataclasses import replace
from math import atan2, cos, degrees, hypot, pi, sin

from models.description.robot import FOLDER
from models.morphology.mjcf import write_mjcf
from models.morphology.shipped import FEET, HEXAPOD, KAPPA, PIVOTS

TRIPODS = """
[group]
1 = { legs = { 1 = -1, 4 = -1, 5 = -1 } }
2 = { legs = { 2 = 1, 3 = 1, 6 = 1 } }
[gait]
strata = ["12", "1", "12", "2", "12"]
"""


def write(folder, name, body, card=None):
    path = folder / f"{name}.xml"
    path.write_text(body)
    if card is not None:
        path.with_suffix(".toml").write_text(card)
    return path


def mantis(folder):
    """Three joints a leg, the knee held; motors, degrees, nested defaults.

    Its feet are the lower ends of its shanks; the body is defined away from the origin,
    turned and above the ground; the only plane is a wall; a sensor watches a motor; it
    starts from its keyframe `home`, with its shanks upright.
    """
    hips = {
        "lf": (0.12, 0.06, 45),
        "rf": (0.12, -0.06, -45),
        "lm": (0.0, 0.09, 90),
        "rm": (0.0, -0.09, -90),
        "lr": (-0.12, 0.06, 135),
        "rr": (-0.12, -0.06, -135),
    }
    legs = "".join(
        f"""
      <body name="coxa_{n}" pos="{x} {y} 0" euler="{yaw} 0 0">
        <joint class="yaw" name="{n}_1"/>
        <geom class="visual" type="cylinder" size="0.012 0.02"/>
        <geom class="link" fromto="0 0 0 0.05 0 0"/>
        <body name="femur_{n}" pos="0.05 0 0">
          <joint class="pitch" name="{n}_2"/>
          <geom class="link" fromto="0 0 0 0.08 0 0"/>
          <body name="tibia_{n}" pos="0.08 0 0">
            <joint class="knee" name="{n}_3"/>
            <geom class="shank" name="shank_{n}" fromto="0 0 0 0 0 -0.12"/>
            <site name="toe_{n}" pos="0 0 -0.12" size="0.01"/>
          </body>
        </body>
      </body>"""
        for n, (x, y, yaw) in hips.items()
    )
    motors = "".join(
        f'<motor name="m_{n}_{k}" joint="{n}_{k}" gear="30" ctrlrange="-1 1"/>'
        for n in hips
        for k in (1, 2, 3)
    )
    body = f"""<mujoco model="mantis">
  <compiler angle="degree" eulerseq="zyx" autolimits="true"/>
  <option timestep="0.002" integrator="Euler" cone="pyramidal"/>
  <default>
    <default class="mantis">
      <geom contype="0" conaffinity="0" density="400"/>
      <joint damping="0.5" armature="0.005"/>
      <default class="yaw"><joint axis="0 0 1" range="-60 60"/></default>
      <default class="pitch">
        <joint axis="0 1 0" range="-80 80"/>
        <default class="knee"><joint range="-100 100"/></default>
      </default>
      <default class="visual"><geom group="2" mass="0"/></default>
      <default class="link">
        <geom type="capsule" size="0.01"/>
        <default class="shank">
          <geom size="0.009" contype="2" conaffinity="1" priority="1" friction="0.8"/>
        </default>
      </default>
    </default>
  </default>
  <worldbody>
    <geom name="wall" type="plane" size="1 1 0.1" pos="-3 0 0" euler="0 90 0"/>
    <body name="base" childclass="mantis" pos="1.5 -2 0.5" euler="30 0 0">
      <freejoint/>
      <geom type="box" size="0.14 0.07 0.02" density="700"/>{legs}
    </body>
  </worldbody>
  <actuator>{motors}</actuator>
  <sensor><actuatorfrc actuator="m_lf_1"/></sensor>
  <keyframe>
    <key name="folded" qpos="0 0 0.1 1 0 0 0 {"0 1 1 " * 6}"/>
    <key name="home" qpos="0 0 0.1 1 0 0 0 {"0 -0.1 0.1 " * 6}" ctrl="{"0.1 " * 18}"/>
  </keyframe>
</mujoco>"""
    legs = "".join(
        f'[leg.{i}]\nswing = "{n}_1"\nlift = "{n}_2"\nraise = -1\n'
        f'foot = ["shank_{n}"]\nhold = {{ {n}_3 = 0.1 }}\n'
        for i, n in enumerate(hips, start=1)
    )
    servo = "[servo]\nstiffness = 1000.0\ndamping = 6.0\n"
    return write(folder, "mantis", body, f"lift_angle = 0.3\n{legs}{servo}{TRIPODS}")


def padder(folder):
    """Flat square feet, servos behind gears, quaternions, inertias; its card inside.

    Its floor is a metre below the origin and in a body of its own; its keyframe is
    beside the middle and off that floor; two more keyframes fit its actuators alone.
    """
    bodies = ""
    for n, (x, y) in FEET.items():
        dx, dy = KAPPA * (x - PIVOTS[n][0]), KAPPA * (y - PIVOTS[n][1])
        length, half = hypot(dx, dy), atan2(dy, dx) / 2
        quat = f"{cos(half):.9f} 0 0 {sin(half):.9f}"
        bodies += f"""
      <body name="arm{n}" pos="{x - dx:.9f} {y - dy:.9f} 0" quat="{quat}">
        <inertial pos="0.04 0 -0.01" mass="0.02" diaginertia="1e-5 1e-5 1e-5"/>
        <joint name="yaw{n}" axis="0 0 1" range="-0.5 0.5" armature="0.002"/>
        <body name="leg{n}">
          <inertial pos="0.05 0 -0.02" mass="0.03" diaginertia="1e-5 2e-5 2e-5"/>
          <joint name="roll{n}" axis="0 1 0" range="-0.6 0.2" armature="0.002"/>
          <geom name="pad{n}" type="box" size="0.008 0.008 0.004"
                pos="{length:.9f} 0 -0.056"/>
        </body>
      </body>"""
    servos = "".join(
        f'<position joint="{kind}{n}" kp="250" kv="0.7" gear="2" ctrlrange="-1 1"/>'
        for n in FEET
        for kind in ("yaw", "roll")
    )
    legs = "\n".join(
        f'{n} = {{ swing = "yaw{n}", lift = "roll{n}", raise = -1, foot = ["pad{n}"] }}'
        for n in FEET
    )
    zeros = "0 " * 12
    body = f"""<mujoco model="padder">
  <compiler angle="radian" inertiafromgeom="auto"/>
  <custom>
    <text name="card" data='lift_angle = 0.25
[leg]
{legs}
{TRIPODS}'/>
  </custom>
  <worldbody>
    <body pos="0 0 -1"><geom type="plane" size="5 5 0.1"/></body>
    <body name="trunk" pos="0 0 2">
      <joint type="free"/>
      <geom type="box" size="0.08 0.1 0.01" mass="0.9" pos="0 0 0.02"
            contype="0" conaffinity="0"/>{bodies}
    </body>
  </worldbody>
  <actuator>{servos}</actuator>
  <keyframe>
    <key name="start" qpos="0.3 0.2 -0.8 0.8 0 0 0.6 {zeros}"/>
    <key name="other" ctrl="{"0.1 " * 12}"/>
    <key ctrl="{zeros}"/>
  </keyframe>
</mujoco>"""
    return write(folder, "padder", body)


def star(folder):
    """Six replicated radial legs in frames, ellipsoid feet, damping ratios.

    Servos inherit the joints' ranges; static bodies are fused; the robot stands with
    its legs turned, and its floor is the testbed's own.
    """
    hub, pivot = 0.08, 0.05
    turned = []
    for k in range(6):
        bearing = (2 * k + 1) * pi / 6
        x, y = hub * cos(bearing), hub * sin(bearing)
        angle = atan2(y + (pivot if k % 2 == 0 else -pivot), x) - bearing
        turned.append((angle + pi) % (2 * pi) - pi)
    servos = "".join(
        f'<position joint="{kind}{k}"/>' for k in range(6) for kind in ("turn", "tilt")
    )
    qpos = " ".join(f"{angle:.9f} 0" for angle in turned)
    body = f"""<mujoco model="star">
  <compiler angle="degree" fusestatic="true" autolimits="true"/>
  <option timestep="0.004"/>
  <default>
    <geom material="metal" contype="0" conaffinity="0"/>
    <joint armature="0.0015" range="-{degrees(0.85):.6f} {degrees(0.85):.6f}"/>
    <position kp="300" dampratio="1" inheritrange="1"/>
    <default class="paw">
      <geom type="ellipsoid" size="0.012 0.012 0.009" condim="6"
            contype="1" conaffinity="1"/>
    </default>
  </default>
  <asset><material name="metal" rgba="0.6 0.6 0.7 1"/></asset>
  <worldbody>
    <frame pos="0 0 0.3" euler="0 0 90">
      <body name="hub" pos="0.2 0 0">
        <joint name="float" type="free"/>
        <geom type="cylinder" size="0.075 0.012" mass="1.1"/>
        <body name="mast"><geom type="box" size="0.02 0.01 0.03" mass="0.05"/></body>
        <replicate count="6" euler="0 0 60">
          <frame euler="0 0 30">
            <body name="arm" pos="{hub} 0 0">
              <joint name="turn" axis="0 0 1"/>
              <geom type="sphere" size="0.012" mass="0.02"/>
              <body name="beam">
                <joint name="tilt" axis="0 -1 0" range="-20 50"/>
                <geom type="capsule" fromto="0 0 0 0.11 0 -0.05" size="0.006"
                      mass="0.04"/>
                <geom class="paw" name="paw" pos="0.11 0 -0.055" mass="0.005"/>
              </body>
            </body>
          </frame>
        </replicate>
      </body>
    </frame>
  </worldbody>
  <actuator>{servos}</actuator>
  <keyframe><key name="start" qpos="0 0 0.1 1 0 0 0 {qpos}"/></keyframe>
</mujoco>"""
    names = {1: 0, 2: 5, 3: 1, 4: 4, 5: 2, 6: 3}
    legs = "".join(
        f'[leg.{n}]\nswing = "turn{k}"\nlift = "tilt{k}"\nfoot = ["paw{k}"]\n'
        for n, k in names.items()
    )
    return write(folder, "star", body, f"lift_angle = 0.3\n{legs}{TRIPODS}")


def scaled(folder, size):
    """The shipped hexapod at another size, of the same stuff, its servos to match."""

    def longer(point):
        return tuple(size * x for x in point)

    legs = {
        number: replace(leg, hip=longer(leg.hip), foot=longer(leg.foot))
        for number, leg in HEXAPOD.legs.items()
    }
    shape = replace(
        HEXAPOD,
        legs=legs,
        hip_height=size * HEXAPOD.hip_height,
        plate=longer(HEXAPOD.plate),
        body_mass=size**3 * HEXAPOD.body_mass,
        leg_mass=size**3 * HEXAPOD.leg_mass,
        leg_radius=size * HEXAPOD.leg_radius,
        hip_radius=size * HEXAPOD.hip_radius,
        foot_radius=size * HEXAPOD.foot_radius,
        stiffness=size**4 * HEXAPOD.stiffness,
        damping=size**4.5 * HEXAPOD.damping,
        armature=size**5 * HEXAPOD.armature,
    )
    (folder / "scene.xml").write_text((FOLDER / "scene.xml").read_text())
    body = write_mjcf(shape, [(1, 4, 5), (2, 3, 6)])
    return write(folder, "scaled", body, (FOLDER / "hexapod.toml").read_text())
