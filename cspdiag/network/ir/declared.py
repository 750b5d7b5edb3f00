"""The common fields of everything that a text declares."""

from __future__ import annotations

from cspdiag.base import Span
from cspdiag.base.record import Slotted, record


@record(kw_only=True)
class Declared:
    """Something with a name, a doc comment and a place."""

    name: str
    doc: str | None = None
    span: Span


@record(kw_only=True)
class DeclaredElement(Slotted):
    """The same for what large programs have by the hundred thousand."""

    name: str
    doc: str | None = None
    span: Span
