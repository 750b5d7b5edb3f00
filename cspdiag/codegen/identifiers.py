"""Names of the text as identifiers of other languages."""

from __future__ import annotations

import re
from collections.abc import Iterable


def distinct(names: Iterable[str], prefix: str = "") -> list[str]:
    """An identifier for each name, all different; ``prefix`` keeps them apart from words of the language."""
    taken: set[str] = set()
    found = []
    for name in names:
        plain = re.sub(r"\W+", "_", name).strip("_") or "unnamed"
        identifier = base = f"{prefix}{plain}" if prefix or not plain[0].isdigit() else f"_{plain}"
        number = 1
        while identifier in taken:
            number += 1
            identifier = f"{base}_{number}"
        taken.add(identifier)
        found.append(identifier)
    return found
