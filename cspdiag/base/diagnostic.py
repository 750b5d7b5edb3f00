"""The diagnostics that are reported to the user.

Each kind of diagnostic is a subclass in the folder ``diagnostics`` of the layer that finds it. Its manual page
(``cspdiag explain CODE``) is a file in ``manual/``.
"""

from __future__ import annotations

import re
from typing import ClassVar, Literal, Self

from cspdiag.base.record import record, replaced
from cspdiag.base.span import Span

Severity = Literal["error", "warning"]

LONGEST_NAME = 80
"""In characters; of a longer name or number in a message the beginning and the end are shown."""
_LONG_NAME = re.compile(rf"\w{{{LONGEST_NAME + 1},}}", re.ASCII)


def with_short_names(text: str) -> str:
    """A sentence in which no name is longer than ``LONGEST_NAME``."""
    half = LONGEST_NAME // 2
    return _LONG_NAME.sub(lambda name: f"{name[0][:half]}…{name[0][1 - half :]}", text)


@record
class Label:
    """A further place that belongs to a diagnostic, with a few words about it."""

    span: Span
    message: str


@record
class Edit:
    """A change of the text: ``replacement`` for what is at ``span``, which may be empty."""

    span: Span
    replacement: str


@record
class Words:
    """What a diagnostic says, with names that are short enough to be read."""

    message: str
    label: str
    help: str | None
    labels: tuple[Label, ...]


@record
class Diagnostic:
    """One thing that is wrong, where, why, and how to correct it.

    A subclass is a ``record`` that sets ``code`` and ``title`` and adds the facts it needs as fields; ``message``,
    ``help`` and ``labels`` make sentences of them. A sentence without facts is a class attribute, as ``code`` is.
    """

    code: ClassVar[str]
    title: ClassVar[str]
    severity: ClassVar[Severity] = "error"

    span: Span

    @property
    def message(self) -> str:
        """What is wrong, in one sentence in the words of the diagram, without a final full stop."""
        raise NotImplementedError

    @property
    def label(self) -> str:
        """A few words below the marked source; may be empty."""
        return ""

    @property
    def help(self) -> str | None:
        """How to correct it, or None if there is no useful advice; by default the field ``advice``."""
        advice: str | None = vars(self).get("advice")
        return advice

    @property
    def edits(self) -> tuple[Edit, ...]:
        """The correction, if exactly one is certainly meant: changes that belong together, none inside another.
        Anything less certain is only in ``help``.
        """
        return ()

    def __repr__(self) -> str:
        return f"<{self.code} {self}>"

    def __str__(self) -> str:
        line, column = self.span.source.position(self.span.start)
        return f"{self.span.file}:{line}:{column}: {with_short_names(self.message)}"

    @property
    def words(self) -> Words:
        """What it says, to be shown; names of many characters are shortened, since a text may be damaged."""
        return Words(
            with_short_names(self.message),
            with_short_names(self.label),
            None if self.help is None else with_short_names(self.help),
            tuple(Label(label.span, with_short_names(label.message)) for label in self.all_labels),
        )

    @property
    def labels(self) -> tuple[Label, ...]:
        """The other places involved."""
        return ()

    def with_labels(self, further: tuple[Label, ...]) -> Self:
        """The same diagnostic with additional places, which its finder does not know."""
        copied = replaced(self)
        vars(copied)["_further"] = further
        return copied

    @property
    def all_labels(self) -> tuple[Label, ...]:
        """The other places to show: those involved, and those that were added."""
        further: tuple[Label, ...] = vars(self).get("_further", ())
        return (*self.labels, *further)
