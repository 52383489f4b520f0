"""Write the MJCF files of the shipped robots from their lengths."""

from models.description import FOLDER, parse_card
from models.morphology import MORPHOLOGIES, write_mjcf


def main() -> None:
    """Write one MJCF file a shape, beside its card."""
    for morphology in MORPHOLOGIES:
        path = FOLDER / f"{morphology.name}.xml"
        card = path.with_suffix(".toml").read_text()
        groups = parse_card(card, str(path)).groups.values()
        path.write_text(write_mjcf(morphology, [group.legs for group in groups]))
        print(f"wrote {path.name}")


if __name__ == "__main__":
    main()
