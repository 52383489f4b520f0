"""Origins of joints in a robot's URDF file, and of its meshes."""

from xml.etree import ElementTree as ET

from models.adoption.source import _parsed, _place, source_of
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


def test_urdf_finds_meshes_beside_itself_in_a_folder_of_any_name(tmp_path):
    path = ADOPTEES[-1].write(tmp_path)
    (tmp_path / "meshes").mkdir()
    corners = "v 0 0 0\nv 0.01 0 0\nv 0 0.01 0\nv 0 0 0.01\n"
    faces = "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
    (tmp_path / "meshes" / "hull.obj").write_text(corners + faces)
    hull = '<geometry><mesh filename="package://bot/meshes/hull.obj"/></geometry>'
    shape = f"<collision>{hull}</collision></link>"
    path.write_text(path.read_text().replace("</link>", shape, 1))
    source = source_of(str(path))
    assert "meshes/hull.obj" in source.text
    assert not source.notes
