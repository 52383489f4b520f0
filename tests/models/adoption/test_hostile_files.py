"""URDF files from strangers: tried within limits, and read from their folder alone."""

import os
import re

import pytest

from models.adoption.source import source_of
from models.errors import ModelError
from scripts.adoptees import ADOPTEES

URDF = """<robot name="r"><mujoco><compiler strippath="{strip}"/>{more}</mujoco>
<link name="base">
  <inertial>{origin}<mass value="1"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
  <collision><geometry><mesh filename="{mesh}"/></geometry></collision>
</link></robot>
"""
CENTRE = '<origin xyz="0.1 0 0"/>'
ABSENT = {
    "a mesh of a ROS package": "package://r/meshes/m.stl",
    "a mesh of another machine": "http://host/m.stl",
    "a name that no file has": "x" * 300,
    "a package that no folder has": f"package://{'x' * 300}/m.stl",
}
PYRAMID = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
SENT = {
    "a mesh by its full path": ("{out}/m.obj", "outside its own folder: .*m.obj"),
    "a mesh above": ("../out/m.obj", "outside its own folder: .*m.obj"),
    "a mesh behind a link": ("link.obj", "outside its own folder: .*link.obj"),
    "a mesh by a URL": ("file://{out}/m.obj", "m.obj"),
    "a pipe for a mesh": ("pipe.stl", "not a file: .*pipe.stl"),
    "a device for a mesh": ("/dev/zero", "not a file: /dev/zero"),
}


@pytest.fixture
def urdf(tmp_path):
    """Write a URDF with such a mesh; its path."""
    out, own = tmp_path / "out", tmp_path / "own"
    out.mkdir()
    own.mkdir()
    (out / "m.obj").write_text(PYRAMID)
    (own / "near.obj").write_text(PYRAMID)
    (own / "link.obj").symlink_to(out / "m.obj")
    os.mkfifo(own / "pipe.stl")

    def write(mesh, strip="false", more="", origin=""):
        mesh = mesh.format(out=out)
        text = URDF.format(strip=strip, more=more, mesh=mesh, origin=origin)
        (own / "mine.urdf").write_text(text)
        return own / "mine.urdf"

    return write


@pytest.mark.parametrize(("mesh", "said"), SENT.values(), ids=SENT)
def test_a_urdf_opens_nothing_outside_its_folder_and_waits_for_no_pipe(
    urdf, mesh, said
):
    with pytest.raises(ModelError, match=said) as refused:
        source_of(str(urdf(mesh)))
    assert len(str(refused.value).splitlines()) == 1


def test_a_path_that_the_compiler_cuts_off_leads_nowhere(urdf):
    with pytest.raises(ModelError, match="no end of link 'base' is known"):
        source_of(str(urdf("../out/m.obj", strip="true")))


def test_a_urdf_may_be_written_in_any_way_that_xml_is(urdf):
    path = urdf("near.obj")
    text = path.read_text()
    path.write_text(text.replace('"', "'").replace("</robot>", "</robot\n>"))
    own = source_of(str(path)).text
    path.write_text(text)
    assert own == source_of(str(path)).text


def test_a_base_in_a_comment_is_none_and_lines_are_counted_with_it(urdf):
    path = urdf("near.obj")
    text = path.read_text()
    path.write_text(text.replace("<link", '<!-- <link\n name="old"/> --><link', 1))
    own = source_of(str(path)).text
    path.write_text(text.replace("<link", "<link  type='x'\n", 1))
    assert own == source_of(str(path)).text
    lost = text.replace("<link", "<!--\n\n--><link", 1).replace("<mass", "<mass <")
    path.write_text(lost)
    with pytest.raises(
        ModelError, match=f"line {lost[: lost.index('<mass <')].count(chr(10)) + 1}"
    ):
        source_of(str(path))


def test_limits_the_wrong_way_round_are_refused(tmp_path):
    """The engine would let such a joint turn freely."""
    path = next(one for one in ADOPTEES if one.name == "box").write(tmp_path)
    text = path.read_text()
    for low, high in ((1.2, -1.2), (0.5, 0.5), (0, 0)):
        ends = f'lower="{low}" upper="{high}"'
        path.write_text(re.sub('lower="[^"]*" upper="[^"]*"', ends, text, count=1))
        with pytest.raises(ModelError, match=f"'yaw1' has limits from {low} to {high}"):
            source_of(str(path))
    free = path.read_text().replace('type="revolute"', 'type="continuous"')
    path.write_text(free)
    assert source_of(str(path)).text
    path.write_text(text.replace('lower="-1.2" upper="1.2"', ""))
    assert source_of(str(path)).text


def test_a_base_may_have_any_name(tmp_path):
    path = next(one for one in ADOPTEES if one.name == "box").write(tmp_path)
    own, text = source_of(str(path)).text, path.read_text()
    path.write_text(text.replace('"trunk"', '"a&quot;b &amp;c"'))
    assert source_of(str(path)).text == own.replace("trunk", "a&quot;b &amp;c")


OTHERS = {
    "links of simulators": '<gazebo><plugin><link name="g"/></plugin></gazebo>',
    "links that are not merged": '<mujoco><compiler fusestatic="false"/></mujoco>',
}


@pytest.mark.parametrize("more", OTHERS.values(), ids=OTHERS)
def test_what_others_write_into_a_urdf_changes_nothing(tmp_path, more):
    path = next(one for one in ADOPTEES if one.name == "box").write(tmp_path)
    own, text = source_of(str(path)).text, path.read_text()
    path.write_text(text.replace('<robot name="box">', f'<robot name="box">{more}'))
    assert source_of(str(path)).text == own


def test_a_base_that_floats_by_a_joint_of_its_own_is_refused_by_that(tmp_path):
    path = next(one for one in ADOPTEES if one.name == "box").write(tmp_path)
    own = '<link name="odom"/><joint name="f" type="floating"><parent link="odom"/>'
    head, text = '<robot name="box">', path.read_text()
    path.write_text(text.replace(head, f'{head}{own}<child link="trunk"/></joint>'))
    with pytest.raises(ModelError, match="joint 'f' floats, .*; take it out, and"):
        source_of(str(path))


def test_two_links_without_a_parent_are_refused_by_their_names(tmp_path):
    path = next(one for one in ADOPTEES if one.name == "box").write(tmp_path)
    path.write_text(path.read_text().replace("</robot>", '<link name="lost"/></robot>'))
    with pytest.raises(ModelError, match="links 'trunk' and 'lost' hang from no joint"):
        source_of(str(path))


def test_two_joints_of_one_name_are_refused_by_it(tmp_path):
    path = next(one for one in ADOPTEES if one.name == "box").write(tmp_path)
    first, second, *_ = re.findall('<joint name="([^"]*)"', text := path.read_text())
    path.write_text(text.replace(f'<joint name="{second}"', f'<joint name="{first}"'))
    with pytest.raises(ModelError, match=f"two joints have the name '{first}': "):
        source_of(str(path))


def test_a_robot_that_is_fixed_to_the_ground_is_refused(tmp_path):
    path = next(one for one in ADOPTEES if one.name == "box").write(tmp_path)
    fixed = '<link name="world"/><joint name="f" type="fixed"><parent link="world"/>'
    text = path.read_text().replace(
        '<robot name="box">',
        f'<robot name="box">{fixed}<child link="trunk"/></joint>',
    )
    path.write_text(text)
    with pytest.raises(ModelError, match="the link 'world', which is the ground: "):
        source_of(str(path))


@pytest.mark.parametrize(
    ("file", "compiler"),
    [
        ("near.obj", 'meshdir="meshes"'),
        ("any/near.obj", 'meshdir="meshes" strippath="true"'),
    ],
)
def test_meshes_are_found_where_the_compiler_looks_for_them(urdf, file, compiler):
    path = urdf(file)
    folder = path.parent / "meshes"
    folder.mkdir()
    (path.parent / "near.obj").rename(folder / "near.obj")
    text = path.read_text()
    path.write_text(text.replace('strippath="false"', compiler))
    found = source_of(str(path))
    assert found.notes == ()
    assert 'meshdir="meshes"' in found.text


@pytest.mark.parametrize("mesh", ["file://near.obj", "file://{out}/../own/near.obj"])
def test_meshes_by_the_address_of_a_file_are_found(urdf, mesh):
    assert source_of(str(urdf(mesh))).notes == ()


def test_a_mesh_is_not_found_where_the_compiler_does_not_look(urdf):
    """Of that name is another file, beside the drawing."""
    (note,) = source_of(str(urdf("any/near.obj", origin=CENTRE))).notes
    assert "any/near.obj" in note


def test_a_folder_is_not_searched_beyond_what_is_read(tmp_path):
    with (tmp_path / "a.xml").open("w") as file:
        file.truncate(10**12)
    with pytest.raises(OSError, match="larger than 10 MB"):
        source_of(str(tmp_path))


def test_a_mesh_that_no_link_has_is_refused(urdf):
    path = urdf("gone.obj")
    path.write_text('<robot name="r"><mesh filename="gone.obj"/></robot>')
    with pytest.raises(ModelError, match="not a usable URDF file"):
        source_of(str(path))


DRAWN = "<visual><geometry><box size='1 1 1'/></geometry></visual>"


@pytest.mark.parametrize("depth", [1000, 500_000])  # Python's limit; 3.5 MB
def test_a_urdf_that_is_nested_too_deeply_is_refused(urdf, depth):
    path = urdf("near.obj")
    nested = "<a>" * depth + "</a>" * depth
    path.write_text(f'<robot name="r"><link name="a">{DRAWN}{nested}</link></robot>')
    with pytest.raises(ModelError, match="^nested too deeply: .*mine.urdf; take"):
        source_of(str(path))


def test_a_warning_of_the_engine_is_written_nowhere(urdf, capfd, monkeypatch):
    """Not of a joint whose limits are equal, say."""
    mass = (
        '<inertial><mass value="1"/>'
        '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    )
    path = urdf("near.obj")
    path.write_text(
        f'<robot name="r"><link name="a">{mass}</link><link name="b">{mass}</link>'
        '<joint name="j" type="revolute"><parent link="a"/><child link="b"/>'
        '<limit lower="0"/></joint></robot>'
    )
    monkeypatch.chdir(path.parent)
    before = os.listdir()
    with pytest.raises(ModelError, match="'j' has limits from 0 to 0"):
        source_of(str(path))
    assert os.listdir() == before
    assert capfd.readouterr() == ("", "")


def test_a_urdf_that_is_trusted_opens_what_it_names(urdf):
    assert source_of(str(urdf("../out/m.obj")), allow_external=True).text


@pytest.mark.parametrize("mesh", ABSENT.values(), ids=ABSENT)
def test_a_mesh_that_is_nowhere_to_be_opened_is_left_out_and_named(urdf, mesh):
    source = source_of(str(urdf(mesh, origin=CENTRE)))
    assert f"its meshes are missing, {mesh}: links become rods" in source.notes[0]
    assert "<mesh" not in source.text
    with pytest.raises(ModelError, match="no end of link 'base' is known: .*its mesh"):
        source_of(str(urdf(mesh)))


def test_a_mesh_that_is_only_drawn_is_left_out_without_a_rod(urdf):
    text = (path := urdf("near.obj")).read_text()
    drawn = '<visual><geometry><mesh filename="gone.dae"/></geometry></visual>'
    path.write_text(text.replace("<collision>", f"{drawn}<collision>"))
    assert not any("gone" in note for note in source_of(str(path)).notes)
    touches = drawn.replace("visual", "collision")
    path.write_text(text.replace("<collision>", f"{touches}<collision>"))
    (note,) = (note for note in source_of(str(path)).notes if "gone" in note)
    assert note.startswith("link base touches with its other shapes alone, as its mesh")


@pytest.mark.parametrize("mesh", ["near.obj", *ABSENT.values()])
@pytest.mark.parametrize(
    ("other", "said"),
    [("/etc/passwd", "/etc/passwd"), ("pipe.stl", "not a file: .*pipe.stl")],
    ids=["a file elsewhere", "a pipe"],
)
def test_an_include_of_a_urdf_is_looked_at_too(urdf, mesh, other, said):
    include = f'<include file="{other}"/>'
    with pytest.raises(ModelError, match=said):
        source_of(str(urdf(mesh, more=include, origin=CENTRE)))


@pytest.mark.full
def test_a_urdf_that_grows_without_end_is_refused_in_time(urdf, alone):
    count = 70_000  # 8 MB; 10 MB are the most that is read
    links = "".join(f'<link name="l{i}"/>' for i in range(count))
    joints = "".join(
        f'<joint name="j{i}" type="revolute"><parent link="l{i}"/>'
        f'<child link="l{i + 1}"/></joint>'
        for i in range(count - 1)
    )
    path = urdf("m.obj")
    path.write_text(f'<robot name="r">{links}{joints}</robot>')
    with pytest.raises(ModelError, match="too large: .*more than 8 s or 2 GB"):
        source_of(str(path))


def test_a_number_that_is_none_is_refused_in_a_urdf_as_well(urdf):
    path = urdf("near.obj", origin='<origin xyz="0 nan(1) 0"/>')
    with pytest.raises(ModelError, match="a number is not finite: .*mine.urdf"):
        source_of(str(path))
