"""Names of the text as identifiers of other languages."""

from __future__ import annotations

import re
from collections.abc import Iterable

from cspdiag.network.lower.distinct_names import DistinctNames


def distinct(names: Iterable[str], prefix: str = "") -> list[str]:
    """An identifier for each name, all different; ``prefix`` distinguishes them from words of the language."""
    given = DistinctNames()
    found = []
    for name in names:
        plain = re.sub(r"\W+", "_", name).strip("_") or "unnamed"
        base = f"{prefix}{plain}" if prefix or not plain[0].isdigit() else f"_{plain}"
        found.append(given.fresh(base, f"{base}_{{}}".format))
    return found
