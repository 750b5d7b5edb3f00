"""Finds what was renamed inside a submodel: states, intermediate values, instances, ports and parameters."""

from __future__ import annotations

import re
from collections.abc import Hashable

from cspdiag.base.record import replaced
from cspdiag.draw.differences.change import Parts
from cspdiag.draw.differences.renames import pairs

_NAMED = ("parameter", "port", "state", "let", "instance")
_OWN = "its own name"


def part_renames(before: Parts, after: Parts) -> dict[tuple[str, str], str]:
    """The new names of parts that are equal in everything else, their equations included, by subject and old name.

    What refers to another renamed part is found after that one.
    """
    found: dict[tuple[str, str], str] = {}
    while new := _obvious_renames(before, after):
        found |= new
        before = with_new_names(before, new)
    return found


def _obvious_renames(before: Parts, after: Parts) -> dict[tuple[str, str], str]:
    removed = [(before, key) for key in before if key[0] in _NAMED and key not in after]
    added = [(after, key) for key in after if key[0] in _NAMED and key not in before]
    return {old: new for (_, old), (_, (_, new)) in pairs(removed, added, lambda entry: _signature(*entry))}


def with_new_names(parts: Parts, names: dict[tuple[str, str], str]) -> Parts:
    """The parts with other names, also where equations use them."""
    words = {old: new for (_, old), new in names.items()}
    if not words:
        return parts
    # A member of something else may have the same name.
    pattern = re.compile(rf"(?<![\w.])(?:{'|'.join(map(re.escape, words))})\b")

    def changed(text: str) -> str:
        return pattern.sub(lambda match: words[match[0]], text)

    return {
        (subject, changed(name)): replaced(
            part, text=changed(part.text), aspects={aspect: changed(text) for aspect, text in part.aspects.items()}
        )
        for (subject, name), part in parts.items()
    }


def _signature(parts: Parts, key: tuple[str, str]) -> Hashable:
    """Everything about a part and its equations except its name."""
    subject, name = key
    own = re.compile(rf"(?<![\w.]){re.escape(name)}\b")
    equations = {
        (own.sub(_OWN, other), own.sub(_OWN, part.aspects["value"]))
        for (kind, other), part in parts.items()
        if kind == "equation" and own.search(other)
    }
    aspects = {(aspect, own.sub(_OWN, text)) for aspect, text in parts[key].aspects.items()}
    return subject, frozenset(aspects), frozenset(equations)
