"""Write the MJCF files of the shipped robots from the lengths in `models.shapes`."""

from models.card_file import read_card
from models.mjcf import write
from models.robot import FOLDER
from models.shapes import SHAPES


def main() -> None:
    """Write one MJCF file a shape, beside its card."""
    for shape in SHAPES:
        path = FOLDER / f"{shape.name}.xml"
        groups = read_card(path.with_suffix(".toml")).groups.values()
        path.write_text(write(shape, [group.legs for group in groups]))
        print(f"wrote {path.name}")


if __name__ == "__main__":
    main()
