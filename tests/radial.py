"""Hexapods whose six legs stand around the body and point straight outward."""

from math import cos, radians, sin

BEARINGS = {1: 30, 2: -30, 3: 90, 4: -90, 5: 150, 6: -150}  # of hips [degrees]
LEG = """
      <body name="leg_{n}" pos="{x} {y} 0">
        <joint name="swing_{n}" axis="0 0 1" range="-26 26"/>
        <joint name="lift_{n}" axis="{s} {c} 0" range="-6 34"/>
        <geom name="foot_{n}" type="sphere" size="0.008" mass="0.05"
              pos="{u} {v} -0.05"/>
      </body>"""
BODY = """<mujoco>
  <worldbody>
    <body name="body" pos="0 0 0.06">
      <freejoint/>
      <geom type="cylinder" size="0.075 0.008" pos="0 0 0.018" mass="1"/>{}
    </body>
  </worldbody>
</mujoco>
"""
JOINTS = (
    '[leg.{n}]\nswing = "swing_{n}"\nlift = "lift_{n}"\nraise = 1\n'
    'foot = ["foot_{n}"]\nhold = {{}}\n'
)
SERVO = "[servo]\nstiffness = 1000.0\ndamping = 2.8\n"


def write(folder, digits=12, servo=SERVO, gait='["12", "1", "12", "2", "12"]', turn=7):
    """A robot that can only turn on the spot: all signs are alike.

    `digits` are those of its numbers, and `turn` [degrees] is the bearing of its front,
    which makes rounding hurt.
    """
    legs = ""
    for n, bearing in BEARINGS.items():
        b = radians(bearing + turn)
        x, y, u, v, s, c = (
            round(value, digits)
            for value in (
                *(0.0816 * cos(b), 0.0816 * sin(b)),
                *(0.1084 * cos(b), 0.1084 * sin(b), sin(b), -cos(b)),
            )
        )
        legs += LEG.format(n=n, x=x, y=y, u=u, v=v, s=s, c=c)
    path = folder / "radial.xml"
    path.write_text(BODY.format(legs))
    path.with_suffix(".toml").write_text(
        "lift_angle = 0.3\n"
        + "".join(JOINTS.format(n=n) for n in BEARINGS)
        + "[group]\n1 = { legs = { 1 = 1, 4 = 1, 5 = 1 } }\n"
        + "2 = { legs = { 2 = 1, 3 = 1, 6 = 1 } }\n"
        + f"[gait]\nstrata = {gait}\n{servo}"
    )
    return path
