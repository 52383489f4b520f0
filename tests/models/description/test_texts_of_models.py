"""Texts of models are searched for pipes, which nobody would wait for."""

import os

import pytest

from models.description.inspection import _refuse_pipes
from models.errors import ModelError


@pytest.mark.parametrize(("size", "searched"), [(10**7, True), (10**7 + 1, False)])
def test_texts_of_ten_megabytes_are_searched(tmp_path, size, searched):
    os.mkfifo(tmp_path / "pipe.obj")
    path = tmp_path / "robot.xml"
    path.write_text('<mujoco><asset><mesh file="pipe.obj"/></asset></mujoco>')
    with path.open("a") as file:
        file.write(" " * (size - path.stat().st_size))
    if searched:
        with pytest.raises(ModelError, match=r"not a file: .*pipe\.obj"):
            _refuse_pipes(path, set())
    else:
        _refuse_pipes(path, set())
