"""A folder has as many entries as one takes in at a glance; ``make check`` says which have more.

Entries are modules and folders of modules; ``__init__`` and ``__main__`` do not count, nor do data.

python distribution/room_sizes.py
"""

from __future__ import annotations

import sys
from pathlib import Path

ROOT = Path(__file__).parent.parent
MOST = 14
CROWDED = {
    "cspdiag": "each layer is an entry, and so is what ties them together",
    "tests": "each layer is an entry, and so is what goes through all of them",
}
"""Folders that may have more, and why."""


def complaints(root: Path, crowded: dict[str, str]) -> list[str]:
    """One line for each folder below ``root`` that has too many entries, or needs the exception no more that it has."""
    found = []
    for folder in sorted({path.parent for top in ("cspdiag", "tests") for path in (root / top).rglob("*")}):
        name = folder.relative_to(root).as_posix()
        count = sum(map(_is_entry, folder.iterdir()))
        if count > MOST and name not in crowded:
            found.append(f"{name} has {count} entries, more than {MOST}: give what belongs together a folder")
        if count <= MOST and name in crowded:
            found.append(f"{name} has {count} entries and needs no exception in {Path(__file__).name} any more")
    return [*found, *(f"{name} is no folder" for name in crowded if not (root / name).is_dir())]


def _is_entry(path: Path) -> bool:
    if path.is_dir():
        return path.name != "golden" and any(path.rglob("*.py"))
    return path.suffix == ".py" and path.stem not in ("__init__", "__main__")


if __name__ == "__main__":
    lines = complaints(ROOT, CROWDED)
    print("\n".join(lines), file=sys.stderr, end="\n" if lines else "")
    sys.exit(bool(lines))
