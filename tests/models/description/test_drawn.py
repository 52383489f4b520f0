"""What is drawn of a model fits into memory, however often a drawing is named."""

import pytest
import trimesh

from models.description.inspection import inspect_model
from models.errors import ModelError

MODEL = """<mujoco>
  <asset><mesh name="ball" file="ball.stl"/></asset>
  <worldbody><body><freejoint/><geom size="1"/>{drawn}</body></worldbody>
</mujoco>"""
BALL = '<geom type="mesh" mesh="ball" mass="0" contype="0" conaffinity="0"/>'
SPHERE = '<geom size="0.1" mass="0" contype="0" conaffinity="0"/>'


@pytest.mark.parametrize(
    ("geom", "fits", "many"), [(BALL, 400, 1750), (SPHERE, 1000, 36_000)]
)
def test_each_geom_of_a_drawing_takes_memory_of_its_own(tmp_path, geom, fits, many):
    """Such a ball has 20,480 faces; a replay of a hundred million took 4.8 GB."""
    trimesh.creation.icosphere(subdivisions=5).export(tmp_path / "ball.stl")
    path = tmp_path / "mine.xml"
    path.write_text(MODEL.format(drawn=fits * geom))
    inspect_model(path)
    path.write_text(MODEL.format(drawn=many * geom))
    with pytest.raises(ModelError, match="too large: .*mine.xml; compiled it has"):
        inspect_model(path)
