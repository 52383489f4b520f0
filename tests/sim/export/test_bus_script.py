"""The script that moves servos on a bus speaks their protocols."""

import runpy
from importlib.resources import files


def test_packets_are_those_of_the_makers_manuals():
    script = files("sim.templates") / "bus.txt"
    packets = runpy.run_path(str(script))["packets"]
    torque, goal = packets("ax-12", 1, 512)[:8], packets("ax-12", 1, 512)[8:]
    assert torque == bytes.fromhex("ffff01040318 01de")
    assert goal == bytes.fromhex("ffff0105031e0002d6")  # position 512, protocol 1.0
    # the manual of protocol 2.0 writes 512 to address 116 of servo 1 as an example
    written = bytes.fromhex("fffffd000109000374000002 0000cad9".replace("cad9", "ca89"))
    assert packets("xl-330", 1, 512).endswith(written)
    assert packets("lx-16a", 1, 512) == bytes.fromhex("555501070100020000f4")
