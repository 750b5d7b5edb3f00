"""Checks that no folder has more entries than a reader can take in at a glance; part of ``make check``.

Entries are modules and folders of modules; ``__init__`` and ``__main__`` do not count, nor do data files.

python distribution/folder_sizes.py
"""

from __future__ import annotations

import sys
from pathlib import Path

ROOT = Path(__file__).parent.parent
MAX_ENTRIES = 14
EXCEPTIONS = {
    "cspdiag": "each layer is an entry, and so is what connects them",
    "cspdiag/cli/verbs": "each verb is an entry",
    "tests": "each layer is an entry, and so is what tests all of them together",
}
"""Folders that may have more entries, and why."""


def complaints(root: Path, exceptions: dict[str, str]) -> list[str]:
    """One line for each folder below ``root`` with too many entries, and for each exception that is not needed."""
    found = []
    for folder in sorted({path.parent for top in ("cspdiag", "tests") for path in (root / top).rglob("*")}):
        name = folder.relative_to(root).as_posix()
        count = sum(map(_is_entry, folder.iterdir()))
        if count > MAX_ENTRIES and name not in exceptions:
            found.append(f"{name} has {count} entries, more than {MAX_ENTRIES}: move related ones into a folder")
        if count <= MAX_ENTRIES and name in exceptions:
            found.append(f"{name} has {count} entries: remove its exception from {Path(__file__).name}")
    return [*found, *(f"{name} is not a folder" for name in exceptions if not (root / name).is_dir())]


def _is_entry(path: Path) -> bool:
    if path.is_dir():
        return path.name != "golden" and any(path.rglob("*.py"))
    return path.suffix == ".py" and path.stem not in ("__init__", "__main__")


if __name__ == "__main__":
    lines = complaints(ROOT, EXCEPTIONS)
    print("\n".join(lines), file=sys.stderr, end="\n" if lines else "")
    sys.exit(bool(lines))
