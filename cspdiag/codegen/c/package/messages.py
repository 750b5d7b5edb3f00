"""What a compiler says about a package, with places in the program."""

from __future__ import annotations

import re
from collections.abc import Mapping

_PLACE = re.compile(r"/\*(?:.*\()?\s*([^*()\"]+\.csp:\d+)\)?")
"""In a line of generated code. The kernel gives examples of places, in quotation marks."""
_LEADS_TO_IT = re.compile(r"In file included from |\s+from |[^\s:]+: In function ")
_MOST = 20
"""Lines that are shown: one mistake in a header may lead to thousands."""


def explained(messages: str, files: Mapping[str, str]) -> str:
    """The messages, each place in generated code followed by that in the program; of many lines the first error."""
    return "\n".join(_with_place(row, files) for row in _beginning(messages.splitlines()))


def _beginning(rows: list[str]) -> list[str]:
    """The first error, with what leads to it and follows it, if these are too many lines."""
    if len(rows) <= _MOST:
        return rows
    first = next((number for number, row in enumerate(rows) if "error:" in row), 0)
    while first > 0 and _LEADS_TO_IT.match(rows[first - 1]):
        first -= 1
    shown = rows[first : first + _MOST]
    return [*shown, f"(these are {len(shown)} of {len(rows):,} lines)"]


def _with_place(row: str, files: Mapping[str, str]) -> str:
    found = re.match(r"([^\s:]+):(\d+):", row)
    place = _source_place(files.get(found[1], ""), int(found[2])) if found else None
    return row if place is None else f"{row} [{place}]"


def _source_place(text: str, line: int) -> str | None:
    """The source place from the comment on the line, or from the nearest line above that has one."""
    for row in reversed(text.split("\n")[:line]):
        found = _PLACE.search(row)
        if found is not None:
            return found[1]
        if row == "}":
            return None
    return None
