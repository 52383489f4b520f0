"""Seven hexapods as their owners write them down, five in MJCF and two in URDF.

No joint has an armature, servos are soft and have no names, angles are in degrees, one
robot has a leg that is mirrored, and one URDF names meshes that nobody has.
"""

from math import cos, radians, sin

BOX = (
    (0.08, 0.055),
    (0.08, -0.055),
    (0.0, 0.065),
    (0.0, -0.065),
    (-0.08, 0.055),
    (-0.08, -0.055),
)
OUT = (40, -40, 90, -90, 140, -140)  # headings of the legs of a box [degrees]
PLACED = tuple((*place, heading) for place, heading in zip(BOX, OUT, strict=True))
ROUND = tuple(
    (0.06 * cos(radians(b)), 0.06 * sin(radians(b)), b)
    for b in (30, -30, 90, -90, 150, -150)
)


def _mjcf(folder, name, body, legs, servos, head="", floor=True):
    plane = '<geom type="plane" size="2 2 .1"/>' if floor else ""
    path = folder / f"{name}.xml"
    path.write_text(
        f"<mujoco>{head}<worldbody>{plane}"
        f'<body name="base" pos="0 0 .09"><freejoint/>{body}{"".join(legs)}</body>'
        f"</worldbody><actuator>{''.join(servos)}</actuator></mujoco>"
    )
    return path


def handmade(folder, kp=6):
    """Twelve servos on a plate, the way one types it."""
    legs = [
        f"""<body name="hip{n}" pos="{x} {y} 0" euler="0 0 {heading}">
          <joint name="h{n}" axis="0 0 1" range="-40 40"/>
          <geom type="capsule" fromto="0 0 0 .03 0 0" size=".007" mass=".015"/>
          <body name="leg{n}" pos=".03 0 0">
            <joint name="k{n}" axis="0 1 0" range="-40 40"/>
            <geom type="capsule" fromto="0 0 0 .045 0 .015" size=".005" mass=".01"/>
            <geom type="capsule" fromto=".045 0 .015 .075 0 -.065" size=".005"
              mass=".01"/>
          </body></body>"""
        for n, (x, y, heading) in enumerate(PLACED, start=1)
    ]
    servos = [
        f'<position joint="{j}{n}" kp="{kp}"/>' for n in range(1, 7) for j in "hk"
    ]
    plate = '<geom type="box" size=".1 .05 .012" mass=".3"/>'
    return _mjcf(folder, "handmade", plate, legs, servos)


def spider(folder):
    """Eighteen servos, knees held; a class for all of them, with a largest torque."""
    head = """<compiler angle="degree" autolimits="true"/><default>
      <geom friction="0.8" density="600"/>
      <position kp="8" forcerange="-1.5 1.5"/></default>"""
    legs = [
        f"""<body name="coxa{n}" pos="{x} {y} 0" euler="0 0 {heading}">
          <joint name="coxa{n}" axis="0 0 1" range="-45 45"/>
          <geom type="capsule" fromto="0 0 0 .028 0 0" size=".01"/>
          <body name="femur{n}" pos=".028 0 0" euler="0 -20 0">
            <joint name="femur{n}" axis="0 1 0" range="-70 70"/>
            <geom type="capsule" fromto="0 0 0 .06 0 0" size=".008"/>
            <body name="tibia{n}" pos=".06 0 0" euler="0 95 0">
              <joint name="tibia{n}" axis="0 1 0" range="-60 60"/>
              <geom type="capsule" fromto="0 0 0 .09 0 0" size=".006"/>
            </body></body></body>"""
        for n, (x, y, heading) in enumerate(PLACED, start=1)
    ]
    names = [f"{part}{n}" for n in range(1, 7) for part in ("coxa", "femur", "tibia")]
    servos = [f'<position joint="{name}"/>' for name in names]
    plate = '<geom type="box" size=".1 .05 .015" mass=".6"/>'
    return _mjcf(folder, "spider", plate, legs, servos, head)


def mirrored(folder):
    """The legs on the right copied with their axes turned over, one of them only half.

    Its servos have a damping ratio that nobody uses elsewhere, and one has a name.
    """
    legs, servos = [], []
    for n, (x, y, heading) in enumerate(PLACED, start=1):
        turn, pitch = (1, 1) if y > 0 else (-1, 1 if n == 4 else -1)
        legs.append(
            f"""<body name="hip_{n}" pos="{x} {y} 0" euler="0 0 {heading}">
              <joint name="yaw_{n}" axis="0 0 {turn}" range="-35 35" damping=".01"/>
              <geom type="box" pos=".02 0 0" size=".02 .01 .012" mass=".02"/>
              <body name="leg_{n}" pos=".04 0 0">
                <joint name="pitch_{n}" axis="0 {pitch} 0" range="-50 50"
                  damping=".01"/>
                <geom type="capsule" fromto="0 0 0 .05 0 -.075" size=".006" mass=".02"/>
                <geom type="sphere" pos=".05 0 -.075" size=".008" mass=".002"/>
              </body></body>"""
        )
        servos += [f'<position joint="yaw_{n}" kp="10" dampratio="1"/>']
        servos += [f'<position joint="pitch_{n}" kp="10" dampratio="1"/>']
    servos[0] = servos[0].replace("<position", '<position name="first"')
    plate = '<geom type="box" size=".1 .05 .02" mass=".5"/>'
    return _mjcf(folder, "mirrored", plate, legs, servos)


def turntable(folder):
    """Six legs around a disc, wide ranges, shins that come near one another."""
    legs = [
        f"""<body name="arm_{n}" pos="{x:.5f} {y:.5f} 0" euler="0 0 {heading}">
          <joint name="turn_{n}" axis="0 0 1" range="-80 80"/>
          <geom name="thigh_{n}" type="capsule" fromto="0 0 0 .05 0 .02" size=".008"
            mass=".02"/>
          <body name="shin_{n}" pos=".05 0 .02">
            <joint name="raise_{n}" axis="0 -1 0" range="-30 60"/>
            <geom name="shin_{n}" type="capsule" fromto="0 0 0 .03 0 -.09" size=".014"
              mass=".02"/>
          </body></body>"""
        for n, (x, y, heading) in enumerate(ROUND, start=1)
    ]
    servos = [
        f'<position joint="{j}_{n}" kp="12" kv=".05" ctrlrange="-80 80"/>'
        for n in range(1, 7)
        for j in ("turn", "raise")
    ]
    disc = '<geom type="cylinder" size=".06 .01" mass=".4"/>'
    head = '<compiler angle="degree"/>'
    return _mjcf(folder, "turntable", disc, legs, servos, head, floor=False)


def motors(folder):
    """Plain motors with gears where servos should be, and no floor."""
    legs = [
        f"""<body pos="{1.5 * x} {1.5 * y} 0" euler="0 0 {heading}">
          <joint name="s{n}" axis="0 0 1" range="-30 30"/>
          <geom type="capsule" fromto="0 0 0 .05 0 0" size=".01" mass=".05"/>
          <body pos=".05 0 0">
            <joint name="l{n}" axis="0 1 0" range="-45 45"/>
            <geom type="capsule" fromto="0 0 0 .07 0 -.1" size=".008" mass=".04"/>
          </body></body>"""
        for n, (x, y, heading) in enumerate(PLACED, start=1)
    ]
    servos = [f'<motor joint="{j}{n}" gear="2"/>' for n in range(1, 7) for j in "sl"]
    plate = '<geom type="box" size=".15 .08 .02" mass="1"/>'
    return _mjcf(folder, "motors", plate, legs, servos, floor=False)


INERTIA = '<inertia ixx="2e-6" iyy="2e-6" izz="2e-6" ixy="0" ixz="0" iyz="0"/>'
MESH = '<geometry><mesh filename="package://{package}/meshes/{part}.stl"/></geometry>'


def _link(name, mass, middle, shape):
    shapes = "".join(
        f'<{kind}><origin xyz="{middle}" rpy="{turn}"/>{geometry}</{kind}>'
        for kind in ("visual", "collision")
        for turn, geometry in [shape]
    )
    return (
        f'<link name="{name}"><inertial><origin xyz="{middle}"/><mass value="{mass}"/>'
        f"{INERTIA}</inertial>{shapes}</link>"
    )


def _joint(name, parent, child, place, axis, turn="0 0 0"):
    limit = '<limit lower="-0.7" upper="0.7" effort="1.2" velocity="6"/>'
    return (
        f'<joint name="{name}" type="revolute"><parent link="{parent}"/>'
        f'<child link="{child}"/><origin xyz="{place}" rpy="{turn}"/>'
        f'<axis xyz="{axis}"/>{limit}</joint>'
    )


def _urdf(folder, name, base, links):
    path = folder / f"{name}.urdf"
    path.write_text(f'<?xml version="1.0"?><robot name="{name}">{base}{links}</robot>')
    return path


def boxes(folder):
    """A URDF of boxes and cylinders, with the inertias that an editor left there."""
    cube = '<geometry><box size="{} {} {}"/></geometry>'.format
    rod = '<geometry><cylinder radius=".006" length=".1"/></geometry>'
    base, links = _link("base_link", 0.4, "0 0 0", ("0 0 0", cube(0.2, 0.1, 0.03))), ""
    for n, (x, y, heading) in enumerate(PLACED, start=1):
        turn = f"0 0 {radians(heading)}"
        coxa = ("0 0 0", cube(0.04, 0.02, 0.02))
        links += _link(f"coxa_{n}", 0.02, "0.02 0 0", coxa)
        links += _link(f"leg_{n}", 0.02, "0.035 0 -0.04", ("0 2.4 0", rod))
        links += _joint(
            f"coxa_{n}", "base_link", f"coxa_{n}", f"{x} {y} 0", "0 0 1", turn
        )
        links += _joint(f"leg_{n}", f"coxa_{n}", f"leg_{n}", "0.04 0 0", "0 1 0")
    return _urdf(folder, "boxes", base, links)


def meshes(folder):
    """A URDF out of a drawing programme, whose meshes did not come with it."""

    def part(name):
        return "0 0 0", MESH.format(package="robot_description", part=name)

    base, links = _link("base_link", 0.5, "0 0 0", part("base")), ""
    for n, (x, y, heading) in enumerate(PLACED, start=1):
        turn = f"0 0 {radians(heading)}"
        links += _link(f"coxa_{n}", 0.02, "0.02 0 0", part("coxa"))
        links += _link(f"femur_{n}", 0.03, "0.03 0 0.01", part("femur"))
        links += _link(f"tibia_{n}", 0.03, "0.01 0 -0.045", part("tibia"))
        links += _joint(
            f"coxa_{n}", "base_link", f"coxa_{n}", f"{x} {y} 0", "0 0 1", turn
        )
        links += _joint(f"femur_{n}", f"coxa_{n}", f"femur_{n}", "0.04 0 0", "0 1 0")
        links += _joint(
            f"tibia_{n}", f"femur_{n}", f"tibia_{n}", "0.06 0 0.02", "0 1 0"
        )
    return _urdf(folder, "meshes", base, links)


OWNED = (handmade, spider, mirrored, turntable, motors, boxes, meshes)
