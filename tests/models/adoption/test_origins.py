"""Origins of joints in a robot's URDF file, and of its meshes."""

from xml.etree import ElementTree as ET

import pytest

from models import ModelError
from models.adoption.source import source_of
from models.adoption.urdf import _parsed, _place
from scripts.adoptees import ADOPTEES


def test_a_place_that_is_no_numbers_is_left_to_the_compiler():
    for given in ("a b c", "1 2", ""):
        assert _place(ET.fromstring(f'<origin xyz="{given}"/>')) == (0.0, 0.0, 0.0)
    assert _place(ET.fromstring('<origin xyz="1 2 3"/>')) == (1.0, 2.0, 3.0)
    assert _place(ET.fromstring("<origin/>")) == _place(None) == (0.0, 0.0, 0.0)


def test_elements_have_names_without_namespaces():
    """Those of other namespaces are others', as all readers have it."""
    inside = "<link><a:axis/><!-- no --><axis/></link><a:link><link/></a:link>"
    for own in ("", 'xmlns="http://www.ros.org" '):
        root = _parsed(f'<robot {own}xmlns:a="x">{inside}</robot>')
        assert [e.tag for e in root.iter()] == ["robot", "link", "axis"]


HULL = """
v 0 0 0
v 0.01 0 0
v 0 0.01 0
v 0 0 0.01
f 1 3 2
f 1 2 4
f 1 4 3
f 2 3 4
"""
HIDDEN = '<collision><geometry><mesh filename="{}"/></geometry></collision>'
ENTITY = HIDDEN.replace("<", "&#60;").replace(">", "&#62;")


@pytest.mark.parametrize(
    ("head", "hidden", "said"),
    [
        (f"<!DOCTYPE r [<!ENTITY m '{ENTITY}'>]>", "&m;", "<!ENTITY> is not read"),
        (
            f"<!DOCTYPE r SYSTEM '<!--' [<!ENTITY m '{ENTITY}'>]><!-- -->",
            "&m;",
            "<!ENTITY> is not read",
        ),
        ("", f"<s:collision>{HIDDEN[11:-12]}</s:collision>", "outside its own folder"),
    ],
)
def test_nothing_is_read_that_was_hidden_from_the_inspection(
    head, hidden, said, tmp_path
):
    """Other readers expand entities, and know names by their space."""
    outside = tmp_path / "secret.obj"
    outside.write_text(HULL)
    (tmp_path / "in").mkdir()
    path = ADOPTEES[-1].write(tmp_path / "in")
    text = path.read_text().replace("</link>", f"{hidden.format(outside)}</link>", 1)
    begin = head.format(outside) + '<robot xmlns="x" xmlns:s="x" '
    path.write_text(text.replace("<robot ", begin, 1))
    with pytest.raises(ModelError, match=said):
        source_of(str(path))


def test_urdf_finds_meshes_beside_itself_in_a_folder_of_any_name(tmp_path):
    path = ADOPTEES[-1].write(tmp_path)
    (tmp_path / "meshes").mkdir()
    (tmp_path / "meshes" / "hull.obj").write_text(HULL)
    hull = '<geometry><mesh filename="package://bot/meshes/hull.obj"/></geometry>'
    shape = f"<collision>{hull}</collision></link>"
    path.write_text(path.read_text().replace("</link>", shape, 1))
    source = source_of(str(path))
    assert "meshes/hull.obj" in source.text
    assert not source.notes


def test_instructions_to_xacro_are_refused_unless_they_are_in_comments(tmp_path):
    """They would be dropped, such as the limits of a joint."""
    path = next(one for one in ADOPTEES if one.name == "box").write(tmp_path)
    space = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
    text = path.read_text().replace("<robot ", f"<robot {space} ", 1)
    asked = '<xacro:limits lower="-0.4"/>'
    path.write_text(text.replace("</link>", f"<!-- {asked} --></link>", 1))
    assert source_of(str(path)).text
    path.write_text(text.replace("</link>", f"{asked}</link>", 1))
    with pytest.raises(ModelError, match="; <xacro:limits> is not read; expand it"):
        source_of(str(path))


def test_a_folder_of_meshes_may_have_a_name_that_xml_quotes(tmp_path):
    folder = tmp_path / "R&D"
    folder.mkdir()
    (folder / "hull.obj").write_text(HULL)
    path = next(one for one in ADOPTEES if one.name == "box").write(folder)
    shape = HIDDEN.format("hull.obj")
    path.write_text(path.read_text().replace("</link>", f"{shape}</link>", 1))
    assert 'meshdir="' not in source_of(str(path)).text
