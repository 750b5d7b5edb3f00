"""``check --statistics``: how often each diagnostic was found."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from cspdiag.base.diagnostic import Diagnostic


def counts(diagnostics: Sequence[Diagnostic]) -> list[tuple[int, str, str, int]]:
    """For each code how often it was found, its title, and how many of its findings ``--fix`` corrects; the most
    frequent first.
    """
    found = Counter(diagnostic.code for diagnostic in diagnostics)
    fixable = Counter(diagnostic.code for diagnostic in diagnostics if diagnostic.edits)
    titles = {diagnostic.code: diagnostic.title for diagnostic in diagnostics}
    ordered = sorted(found.items(), key=lambda entry: (-entry[1], entry[0]))
    return [(count, code, titles[code], fixable[code]) for code, count in ordered]


def as_text(diagnostics: Sequence[Diagnostic]) -> str:
    """A line for each code; empty if nothing was found."""
    rows = counts(diagnostics)
    width = max((len(str(count)) for count, *_ in rows), default=0)
    lines = []
    for count, code, title, fixable in rows:
        note = "" if not fixable else " (--fix corrects them)" if fixable == count else f" (--fix corrects {fixable})"
        lines.append(f"{count:>{width}}  {code}  {title}{note}\n")
    return "".join(lines)


def as_json(diagnostics: Sequence[Diagnostic]) -> str:
    """A list of objects with ``count``, ``code``, ``title`` and ``fixable``, the number that ``--fix`` corrects."""
    import json

    rows = [
        {"count": count, "code": code, "title": title, "fixable": fixable}
        for count, code, title, fixable in counts(diagnostics)
    ]
    return f"{json.dumps(rows, indent=2, ensure_ascii=False)}\n"
