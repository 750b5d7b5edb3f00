"""Changes for machines."""

from __future__ import annotations

import json
from collections.abc import Iterable

from cspdiag.base.render.json import place
from cspdiag.draw.differences.change import Change


def render(changes: Iterable[Change]) -> str:
    """A list of objects, empty for no change: ``action``, ``kind`` and ``definition``, ``subject``, ``name`` and
    ``aspect`` of what changed (null where that is the definition itself), ``before`` and ``after``, and the places
    ``from`` and ``to``.
    """
    return json.dumps([_object(change) for change in changes], indent=2, ensure_ascii=False) + "\n"


def _object(change: Change) -> dict[str, object]:
    return {
        "action": change.action,
        "kind": change.kind,
        "definition": change.definition,
        "subject": change.subject or None,
        "name": change.name or None,
        "aspect": change.aspect or None,
        "before": change.before,
        "after": change.after,
        "from": place(change.span_before) or None,
        "to": place(change.span_after) or None,
    }
