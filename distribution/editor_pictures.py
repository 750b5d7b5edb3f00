"""Makes small pictures for the documentation out of screenshots of the extension for VS Code, or of the page of the
studio, from their end-to-end tests.

python distribution/editor_pictures.py vscode|studio FOLDER

takes them from ``FOLDER``, with fewer colours: screenshots differ from machine to machine by their typefaces, so they
are made by hand, with ``make pictures-vscode`` and ``make pictures-studio``.
"""

from __future__ import annotations

import sys
from pathlib import Path

from PIL import Image

PICTURES = Path(__file__).parent.parent / "docs" / "pictures"
NAMES = {"vscode": ("diagram-light", "counterexample"), "studio": ("jiwy-moves", "philosophers-run")}
COLOURS = 64


def main() -> None:
    """Write the pictures of ``NAMES``."""
    target, folder = PICTURES / sys.argv[1], Path(sys.argv[2])
    target.mkdir(parents=True, exist_ok=True)
    for name in NAMES[sys.argv[1]]:
        with Image.open(folder / f"{name}.png") as screenshot:
            screenshot.convert("RGB").quantize(COLOURS).save(target / f"{name}.png", optimize=True)


if __name__ == "__main__":
    main()
