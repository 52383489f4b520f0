"""What strangers send: files that no reader ends, and shapes that break compilers."""

import os
import re
import struct
import time
import zlib

import numpy as np
import pytest

from models.description import inspection
from models.description.robot import FOLDER
from models.errors import ModelError, UnknownRobotError
from models.library import load

HEXAPOD, CARD, SCENE = (
    (FOLDER / name).read_text() for name in ("hexapod.xml", "hexapod.toml", "scene.xml")
)
LIMIT = 35  # seconds in which anything is refused


@pytest.fixture
def robot(tmp_path):
    """Write the shipped hexapod with something more behind its head; its path."""
    own = tmp_path / "own"
    own.mkdir()

    def write(more="", text=HEXAPOD):
        text = re.sub("<mujoco[^>]*>", lambda head: head[0] + more, text, count=1)
        (own / "mine.xml").write_text(text)
        (own / "mine.toml").write_text(CARD)
        (own / "scene.xml").write_text(SCENE)
        return own / "mine.xml"

    return write


def stl(faces, content):
    """An STL file that claims to have so many faces."""
    return bytes(80) + np.uint32(faces).tobytes() + content


def png(width, height, pixels):
    """A grey picture that claims to be so large; its pixels are packed."""

    def chunk(kind, data):
        check = zlib.crc32(kind + data)
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", check)

    head = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    parts = chunk(b"IHDR", head), chunk(b"IDAT", pixels), chunk(b"IEND", b"")
    return b"\x89PNG\r\n\x1a\n" + b"".join(parts)


def packed(count):
    """So many zeros: a gigabyte of them takes a megabyte."""
    packer, block = zlib.compressobj(9), bytes(10**6)
    whole = b"".join(packer.compress(block) for _ in range(count // 10**6))
    return whole + packer.compress(bytes(count % 10**6)) + packer.flush()


def picture(name):
    return f'<asset><hfield name="h" file="{name}" size="1 1 1 1"/></asset>'


def mesh(name):
    return f'<asset><mesh name="m" file="{name}"/></asset>'


FILES = {
    "truncated.stl": stl(4, bytes(20)),
    "endless.stl": stl(2**32 - 1, bytes(50)),
    "flat.stl": stl(1, bytes(50)),
    "nan.stl": stl(1, np.full(12, np.nan, np.float32).tobytes() + bytes(2)),
    "vast.png": png(2**31 - 1, 2**31 - 1, zlib.compress(b"0")),
    "large.png": png(10**5, 10**5, zlib.compress(b"0")),
    "vast.msh": struct.pack("<4i", *[2**31 - 1] * 4) + bytes(100),
    "a.zip": b"PK\x03\x04" + bytes(100),
    "s.skn": np.full(4, 2**30, np.int32).tobytes() + bytes(100),
    "loop.xml": b'<mujoco><include file="mine.xml"/></mujoco>',
    "inner.xml": b'<mujoco><include file="pipe"/></mujoco>',
}
QUICK = {
    "a pipe in an include": ('<include file="inner.xml"/>', "not a file: .*pipe"),
    "a device for an include": ('<include file="/dev/zero"/>', "/dev/zero"),
    "a device for a mesh": (mesh("/dev/zero"), "not a file: /dev/zero"),
    "an include of itself": ('<include file="loop.xml"/>', "already included"),
    "a picture of more points than a number holds": (picture("vast.png"), "too many"),
    "a picture that is larger than its file": (picture("large.png"), "large.png"),
    "a mesh that is larger than its file": (mesh("vast.msh"), "too large sizes"),
    "an archive for an include": ('<include file="a.zip"/>', "a.zip"),
    "frames within frames": (
        f"<worldbody>{'<frame>' * 20_000}{'</frame>' * 20_000}</worldbody>",
        "nesting is too deep",
    ),
    "a name with a zero byte": (
        '<worldbody><geom name="a\0b" size="1"/></worldbody>',
        "not a usable MJCF file",
    ),
    "a skin of a billion points": (
        '<deformable><skin name="s" file="s.skn"/></deformable>',
        "skin|too large",
    ),
}
SLOW = {
    "a missing include": ('<include file="no.xml"/>', "no.xml"),
    "a truncated STL": (mesh("truncated.stl"), "truncated.stl"),
    "an endless STL": (mesh("endless.stl"), "endless.stl"),
    "a flat STL": (mesh("flat.stl"), "at least 4 vertices"),
    "an STL of NaN": (mesh("nan.stl"), "mesh|not finite"),
    "an unknown plugin": (
        '<extension><plugin plugin="evil.so"/></extension>',
        "evil.so",
    ),
    "a share": (mesh("\\\\host\\share\\x.stl"), "host"),
    "a home": (mesh("~/x.stl"), "x.stl"),
    "the surroundings of a process": (
        '<asset><hfield name="m" content_type="image/png" file="/proc/self/environ" '
        'size="1 1 1 1"/></asset>',
        "environ",
    ),
    "itself attached": (
        '<asset><model name="a" file="mine.xml"/></asset><worldbody>'
        '<attach model="a" prefix="q"/></worldbody>',
        "crashes on it|too large",
    ),
    "bodies within bodies": (
        f"<worldbody>{'<body>' * 5000}{'</body>' * 5000}</worldbody>",
        "mine.xml",
    ),
}
SENT = [
    *(pytest.param(*case, id=name) for name, case in QUICK.items()),
    *(pytest.param(*c, id=n, marks=pytest.mark.full) for n, c in SLOW.items()),
]


@pytest.mark.parametrize(("more", "said"), SENT)
def test_what_a_stranger_sends_is_refused_in_time(robot, more, said):
    path = robot(more)
    for name, content in FILES.items():
        (path.parent / name).write_bytes(content)
    os.mkfifo(path.parent / "pipe")
    began = time.monotonic()
    with pytest.raises(ModelError, match=said) as refused:
        load(str(path))
    assert time.monotonic() - began < LIMIT
    assert len(str(refused.value).splitlines()) == 1


def test_entities_are_never_expanded(robot):
    head = '<!DOCTYPE m [<!ENTITY a "aa"><!ENTITY x SYSTEM "file:///etc/passwd">]>'
    path = robot(text=HEXAPOD.replace('name="nose"', 'name="&a;&x;"', 1))
    path.write_text(head + path.read_text())
    assert load(str(path)).model.geom("&a;&x;").id >= 0


@pytest.mark.full
def test_a_picture_of_a_gigabyte_in_a_megabyte_is_refused_in_time(robot):
    path, side = robot(picture("bomb.png")), 30_000
    bomb = png(side, side, packed(side * (side + 1)))
    (path.parent / "bomb.png").write_bytes(bomb)
    assert len(bomb) < 10**6
    began = time.monotonic()
    with pytest.raises(ModelError, match="too large: .*"):
        load(str(path))
    assert time.monotonic() - began < LIMIT


@pytest.mark.full
def test_a_model_that_is_merely_large_is_read(robot):
    geoms = (
        f'<geom size=".001" pos="0 {i} 9" contype="0" conaffinity="0"/>'
        for i in range(10_000)
    )
    path = robot(f"<worldbody>{''.join(geoms)}</worldbody>")
    assert load(str(path)).legs == (1, 2, 3, 4, 5, 6)


def test_joints_are_known_by_their_names(robot):
    head, *legs = HEXAPOD.split('      <body name="leg_')
    last, end, tail = legs[-1].partition("      </body>\n")
    turned = [*legs[:-1], last + end][::-1]
    path = robot(text='      <body name="leg_'.join([head, *turned]) + tail)
    shipped, mine = load("hexapod"), load(str(path))
    assert mine.groups == shipped.groups
    assert mine.model.joint("swing_1").id != shipped.model.joint("swing_1").id


def test_a_folder_that_is_a_link_to_itself_has_no_robot(tmp_path):
    (tmp_path / "loop").symlink_to(tmp_path / "loop")
    with pytest.raises(UnknownRobotError, match="no such robot file"):
        load(str(tmp_path / "loop" / "x.xml"))


@pytest.mark.parametrize(("balls", "large"), [(700, False), (790, True)])
def test_freedoms_are_as_many_as_small_matrices_of_them_hold(tmp_path, balls, large):
    """Some 2,200 of them, whose matrices take 350 MB."""
    body = "<body><joint type='ball' damping='1'/><geom size='.01' contype='0'/></body>"
    path = tmp_path / "balls.xml"
    path.write_text(f"<mujoco><worldbody>{balls * body}</worldbody></mujoco>")
    if not large:
        assert inspection.examine(path) == [path]
        return
    with pytest.raises(ModelError, match="GB"):
        inspection.examine(path)
