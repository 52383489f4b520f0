"""Origins of joints in a robot's URDF file."""

from xml.etree import ElementTree as ET

from models.adoption.source import _parsed, _place


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
