"""What a user's own system may not say at all: too many names, or none."""

import pytest

from models.errors import ProblemError
from models.systems.catalogue import load_system

NAMES = [f"x{n}" for n in range(101)]
MANY = "".join(f"{name} = 1\n" for name in NAMES)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("state = []\n[strata.0]\ng = 5", "field g is 5; give rates, as in { x = 1 }"),
        ("state = []\n[strata.0]\ng = {}", "state is empty; name at least one"),
        (f"state = {NAMES}\n[strata.0]\ng = {{ x0 = 1 }}", "101 coordinates or param"),
        (
            f'state = ["x"]\n[strata.0]\ng = {{ x = 1 }}\n[parameters]\n{MANY}',
            "101 coo",
        ),
    ],
)
def test_names_are_not_too_many_nor_none(tmp_path, text, said):
    """Each formula is read with all of them."""
    (tmp_path / "mine.toml").write_text(f"goal = {{}}\n{text}\n")
    with pytest.raises(ProblemError, match=f"mine.toml; {said}"):
        load_system(tmp_path / "mine.toml")
