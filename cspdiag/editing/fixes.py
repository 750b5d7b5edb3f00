"""The corrections of diagnostics, as editors offer them."""

from __future__ import annotations

import re
from itertools import takewhile

from cspdiag.base.diagnostic import Diagnostic

_LONGEST = 40
"""The longest name or text in a title, in characters."""


def title_of(found: Diagnostic) -> str:
    """What the edits of a diagnostic do, in a few words."""
    if len(found.edits) > 1:
        return f"Fix: {_message(found)}"
    (edit,) = found.edits
    before, after = (" ".join(text.split()) for text in (edit.span.text, edit.replacement))
    if not before:
        return f"Insert `{_shortened(after, _LONGEST)}`"
    if not after:
        return f"Remove `{_shortened(before, _LONGEST)}`"
    return "Replace `{}` by `{}`".format(*_compared(before, after))


def _compared(one: str, other: str) -> tuple[str, str]:
    """Two texts shortened where they are the same, so that what distinguishes them stays."""
    if max(len(one), len(other)) <= _LONGEST:
        return one, other
    head = _common(one, other)
    tail = _common(one[len(head) :][::-1], other[len(head) :][::-1])[::-1]
    ends = (_shortened(head, _LONGEST // 2), _shortened(tail, _LONGEST // 2))
    first, second = (_shortened(each[len(head) : len(each) - len(tail)], _LONGEST) for each in (one, other))
    return first.join(ends), second.join(ends)


def _common(one: str, other: str) -> str:
    """The common beginning of two texts."""
    return "".join(first for first, _ in takewhile(lambda pair: pair[0] == pair[1], zip(one, other, strict=False)))


def _shortened(words: str, longest: int) -> str:
    """A text without its middle if it is long."""
    return words if len(words) <= longest else f"{words[: longest // 2]}…{words[1 - longest // 2 :]}"


def _message(found: Diagnostic) -> str:
    """The message with each long name in it shortened."""
    return re.sub(r"`([^`]*)`", lambda quoted: f"`{_shortened(quoted[1], _LONGEST)}`", found.message)
