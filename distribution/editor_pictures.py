"""Makes small pictures for the documentation out of screenshots of the extension for VS Code, from its end-to-end test.

python distribution/editor_pictures.py FOLDER

takes them from ``FOLDER``, with fewer colours: screenshots differ from machine to machine by their typefaces, so they
are made by hand, with ``make pictures-vscode``.
"""

from __future__ import annotations

import sys
from pathlib import Path

from PIL import Image

TARGET = Path(__file__).parent.parent / "docs" / "pictures" / "vscode"
NAMES = ("diagram-light", "counterexample")
COLOURS = 64


def main() -> None:
    """Write the pictures of ``NAMES``."""
    folder = Path(sys.argv[1])
    TARGET.mkdir(parents=True, exist_ok=True)
    for name in NAMES:
        with Image.open(folder / f"{name}.png") as screenshot:
            screenshot.convert("RGB").quantize(COLOURS).save(TARGET / f"{name}.png", optimize=True)


if __name__ == "__main__":
    main()
