"""Definitions that moved from one file to another, which two comparisons show as removed and added."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence

from cspdiag.base.record import record, replaced
from cspdiag.draw.differences.change import Action, Change
from cspdiag.draw.differences.programs import Difference, differences
from cspdiag.model.program import Program

_Key = tuple[str, str]
"""The kind and the name of a definition."""


@record
class ComparedFile:
    """Both versions of a file, and what changed in it."""

    path: str
    before: Program
    after: Program
    difference: Difference


def with_moves(files: Sequence[ComparedFile]) -> list[Difference]:
    """The differences of all files, in which a definition that one file lost and another one gained has moved: its file
    changed, and what else differs.
    """
    found = [file.difference for file in files]
    lost, gained = _only(files, "removed"), _only(files, "added")
    for key, (source, removed) in lost.items():
        if key not in gained or gained[key][0] == source:
            continue
        target, added = gained[key]
        across = differences(files[source].before, files[target].after, imported=False)
        move = replaced(
            added,
            action="changed",
            aspect="file",
            before=files[source].path,
            after=files[target].path,
            span_before=removed.span_before,
        )
        inner = [change for change in across.changes if _key(change) == key]
        found[source] = _replaced(found[source], key, [], Difference())
        found[target] = _replaced(found[target], key, [move, *inner], across if inner else Difference())
    return found


def _only(files: Sequence[ComparedFile], action: Action) -> dict[_Key, tuple[int, Change]]:
    """The whole definitions that exactly one of the files has lost or gained, with its number."""
    changes = [
        (number, change)
        for number, file in enumerate(files)
        for change in file.difference.changes
        if change.action == action and not change.subject
    ]
    times = Counter(_key(change) for _, change in changes)
    return {_key(change): (number, change) for number, change in changes if times[_key(change)] == 1}


def _replaced(difference: Difference, key: _Key, changes: Iterable[Change], other: Difference) -> Difference:
    """A difference with other ``changes`` of a definition, and the diagrams that ``other`` has of it."""
    kept: list[Change] = []
    for change in difference.changes:
        kept += changes if _key(change) == key else [change]
    _, name = key
    diagrams = [pair for pair in difference.diagrams if pair.name != name]
    diagrams += [pair for pair in other.diagrams if pair.name == name]
    return replaced(difference, changes=tuple(kept), diagrams=tuple(diagrams))


def _key(change: Change) -> _Key:
    return change.kind, change.definition
