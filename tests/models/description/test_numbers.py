"""Numbers that are none are refused wherever a model has them, with the line."""

import struct

import mujoco
import pytest

from models.description.compiled import compile_model
from models.description.inspection import inspect_model
from models.errors import ModelError

MODEL = """<mujoco>
  <option {option}/>
  <default><joint {default}/></default>
  <!-- mass="nan" -->
  <worldbody>
    <camera name="nan" {camera}/>
    <body name="b"><joint name="j" {joint}/><geom name="g" size="1" {geom}/></body>
  </worldbody>
  <keyframe><key name="k" {key}/></keyframe>
</mujoco>
"""
PYRAMID = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
PLACES = {
    "gravity": (
        "option",
        'gravity="0 0 nan"',
        "is not finite: .*mine.xml, line 2;",
    ),
    "wind": ("option", 'wind="nan 0 0"', "line 2; give one that is"),
    "viscosity": ("option", 'viscosity="inf"', "line 2;"),
    "tolerance": ("option", 'tolerance="nan"', "line 2;"),
    "margin": ("geom", 'margin="nan"', "line 7;"),
    "mass": ("geom", "mass='NaN'", "line 7;"),
    "solimp": ("geom", 'solimp="0.9 nan"', "line 7;"),
    "stiffness": ("joint", 'stiffness="inf"', "line 7;"),
    "frictionloss": ("default", 'frictionloss="nan"', "line 3;"),
    "springref": ("joint", 'springref="1e999"', "number is too large in .*'springref'"),
    "camera": ("camera", 'fovy="nan"', "line 6;"),
    "keyframe": ("key", 'time="-inf"', "line 9;"),
}


def text(**said):
    blank = dict.fromkeys(("option", "default", "camera", "joint", "geom", "key"), "")
    return MODEL.format(**blank | said)


@pytest.mark.parametrize(("part", "said", "message"), PLACES.values(), ids=PLACES)
def test_text_with_a_number_that_is_none_is_refused(tmp_path, part, said, message):
    path = tmp_path / "mine.xml"
    path.write_text(text(**{part: said}))
    with pytest.raises(ModelError, match=message) as refusal:
        inspect_model(path)
    assert "mine.xml" in str(refusal.value)
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize("before", [" " * 200, "\n" * 10**4, "words\x0b", "\ufeff" * 2])
def test_what_stands_before_its_elements_hides_no_number(tmp_path, before):
    path = tmp_path / "mine.xml"
    path.write_text(before + text(geom='mass="nan"'))
    with pytest.raises(ModelError, match=f"line {before.count(chr(10)) + 7};"):
        inspect_model(path)
    path.write_bytes((before + text(geom='user="\xe9"')).encode("latin-1", "replace"))
    with pytest.raises(ModelError, match="byte 0xe9 is no text in UTF-8"):
        inspect_model(path)


DISGUISES = {
    "an entity": '<geom size="1" mass="&#110;an"/>',
    "a payload, as in C": '<geom size="1" mass="nan(1)"/>',
    "a blank in the tag": '< geom size="1" mass="nan"/>',
    "sections that begin a comment": (
        '<![CDATA[<!--]]><geom size="1" mass="nan"/><![CDATA[-->]]>'
    ),
    "names that begin a comment": (
        '<site name="<!--"/><geom size="1" mass="nan"/><site name="-->"/>'
    ),
}


@pytest.mark.parametrize("said", DISGUISES.values(), ids=DISGUISES)
def test_a_number_that_is_none_is_refused_however_it_is_written(tmp_path, said):
    path = tmp_path / "mine.xml"
    path.write_text(f"<mujoco><worldbody>{said}</worldbody></mujoco>")
    with pytest.raises(ModelError, match="a number is not finite: .*mine.xml"):
        inspect_model(path)
    path.write_text(
        '<mujoco><worldbody><geom name="nan" size="1"/></worldbody></mujoco>'
    )
    inspect_model(path)


def test_a_drawing_that_is_no_text_is_not_read_as_one(tmp_path):
    header = b"made with <a tool> f\xfcr robots".ljust(80, b" ")
    corners = ((0, 0, 0), (1, 0, 0), (0, 1, 0)), ((0, 0, 0), (0, 1, 0), (0, 0, 1))
    corners += ((0, 0, 0), (0, 0, 1), (1, 0, 0)), ((1, 0, 0), (0, 0, 1), (0, 1, 0))
    faces = [struct.pack("<12fH", 0, 0, 0, *sum(c[::-1], ()), 0) for c in corners]
    stl = header + struct.pack("<I", len(faces)) + b"".join(faces)
    (tmp_path / "foot.stl").write_bytes(stl)
    path = tmp_path / "mine.xml"
    asset = '<mujoco><asset><mesh name="m" file="foot.stl"/></asset>'
    path.write_text(text(geom='type="mesh" mesh="m"').replace("<mujoco>", asset))
    assert inspect_model(path).files == (tmp_path / "foot.stl", path)


def test_a_file_that_is_included_is_read_as_text(tmp_path):
    (tmp_path / "part.xml").write_text('<mujoco><option gravity="0 0 nan"/></mujoco>')
    path = tmp_path / "mine.xml"
    path.write_text(text().replace("<mujoco>", '<mujoco><include file="part.xml"/>'))
    with pytest.raises(ModelError, match="mine.xml, or a file that it includes;"):
        inspect_model(path)
    (tmp_path / "part.xml").write_bytes(
        b'<mujoco><custom><text name="a" data="\xe9"/></custom></mujoco>'
    )
    with pytest.raises(ModelError, match="byte 0xe9 is no text in UTF-8: .*part.xml"):
        inspect_model(path)


@pytest.mark.parametrize("name", ["inf", "NaN", "Infinity"])
def test_names_that_read_as_numbers_are_names(tmp_path, name):
    path = tmp_path / "mine.xml"
    named = text(geom=f'material="{name}"', joint=f'group="1" class="{name}"')
    asset = (
        f'<asset><material name="{name}"/></asset><default><default class="{name}"/>'
    )
    path.write_text(named.replace("<default>", asset))
    inspect_model(path)


def test_text_of_numbers_passes(tmp_path):
    path = tmp_path / "mine.xml"
    path.write_text(text(geom='mass="1e3" user="1 2"'))
    inspect_model(path)


ARRAYS = {
    "a place": ("geom", "pos", "geom_pos of geom 'g' is not finite"),
    "gravity": ("option", "gravity", "opt.gravity is not finite"),
    "colour": ("geom", "rgba", "geom_rgba of geom 'g' is not finite"),
}


SOLVERS = ("iterations", "ls_iterations", "noslip_iterations", "ccd_iterations")
SHAPES = ("sdf_iterations", "sdf_initpoints")


@pytest.mark.parametrize("name", SOLVERS + SHAPES)
def test_a_solver_with_which_a_step_might_not_end_is_refused(name):
    spec = mujoco.MjSpec.from_string(text(option=f'{name}="1000"'))
    compile_model(spec, "here")
    setattr(spec.option, name, 2 * 10**9)
    said = f"{name} of <option> is 2000000000, .*: here; give it 1000 or less"
    with pytest.raises(ModelError, match=said):
        compile_model(spec, "here")


def test_an_actuator_of_several_controls_is_refused():
    """Commands have a column an actuator."""
    servo = '<actuator><pid name="servo" joint="j" kp="5" kv="0.1"/></actuator>'
    spec = mujoco.MjSpec.from_string(text().replace("<keyframe>", f"{servo}<keyframe>"))
    with pytest.raises(ModelError, match="actuator 'servo' has 2 controls: here; give"):
        compile_model(spec, "here")


@pytest.mark.parametrize(("part", "name", "message"), ARRAYS.values(), ids=ARRAYS)
def test_a_compiled_model_is_scanned_whole(part, name, message):
    spec = mujoco.MjSpec.from_string(text())
    element = spec.option if part == "option" else spec.geom("g")
    getattr(element, name)[0] = float("nan")
    with pytest.raises(ModelError, match=message):
        compile_model(spec, "here")
