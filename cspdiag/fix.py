"""Applies the fixes of diagnostics to a program and the files it imports, until no more are found."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence

from cspdiag.base.diagnostic import Diagnostic, Edit
from cspdiag.base.edits import apart, applied
from cspdiag.base.record import record
from cspdiag.base.report import Report
from cspdiag.base.span import SourceFile
from cspdiag.pipeline import Reader, check
from cspdiag.syntax.format.formatter import format_tree
from cspdiag.syntax.parser import parse

_MOST_ROUNDS = 100
"""More than are needed: a fix seldom reveals another diagnostic that can be fixed."""

_UNREADABLE = "E01"
"""The family of errors that keep a text from being read as a whole, so most checks are skipped."""


@record
class FixedFile:
    """A file whose text has changed, and the number of its fixes."""

    before: SourceFile
    text: str
    count: int


@record
class Fixed:
    """The files that have changed, and the diagnostics that are left, none of which has a fix."""

    files: tuple[FixedFile, ...]
    left: tuple[Diagnostic, ...]


class _Files:
    """Files as they were read and as they are now, by the identity of their names: a file that has two names is one
    file.
    """

    def __init__(self, read: Reader, identity: Callable[[str], str]) -> None:
        self._read = read
        self._identity = identity
        self.before: dict[str, SourceFile] = {}
        self.texts: dict[str, str] = {}

    def add(self, source: SourceFile) -> None:
        key = self._identity(source.name)
        self.texts[key] = self.before.setdefault(key, source).text

    def read(self, name: str) -> SourceFile:
        key = self._identity(name)
        if key not in self.before:
            self.add(self._read(name))
        return SourceFile(name=name, text=self.texts[key])

    def key(self, source: SourceFile) -> str | None:
        """None for a text that was not read from a file, such as a bundled library."""
        key = self._identity(source.name)
        return key if self.texts.get(key) is source.text else None

    def fixes(self, found: Sequence[Diagnostic]) -> list[Diagnostic]:
        """Those with edits in these files, none of which touches another."""
        chosen: dict[tuple[object, ...], Diagnostic] = {}
        for diagnostic in found:
            keys = [self.key(edit.span.source) for edit in diagnostic.edits]
            places = [(edit.span.start, edit.span.end) for edit in diagnostic.edits]
            if None not in keys:
                # A file that is read under two names has each diagnostic twice.
                chosen.setdefault((diagnostic.code, *keys, *places), diagnostic)
        return apart(chosen.values())

    def apply(self, changes: Sequence[Diagnostic]) -> None:
        """Change the texts in which these diagnostics were found."""
        edits: dict[str, list[Edit]] = {}
        for edit in (edit for diagnostic in changes for edit in diagnostic.edits):
            key = self.key(edit.span.source)
            assert key is not None
            edits.setdefault(key, []).append(edit)
        self.texts = {key: applied(text, edits.get(key, ())) for key, text in self.texts.items()}


def fix(sources: Sequence[SourceFile], read: Reader, identity: Callable[[str], str]) -> Fixed:
    """Fix programs and the files that they import; bundled libraries stay as they are.

    ``identity`` gives two names of one file the same key. A fix that leads to more errors than before is taken back:
    something else was meant. A file that was formatted before is formatted afterwards.
    """
    files = _Files(read, identity)
    for source in sources:
        files.add(source)
    found = _check(sources, files)
    counts: Counter[str | None] = Counter()
    refused: set[tuple[str, str]] = set()
    for _ in range(_MOST_ROUNDS):
        changes = files.fixes([each for each in found if (each.code, each.message) not in refused])
        if not changes:
            break
        keys = [files.key(each.edits[0].span.source) for each in changes]
        before = files.texts
        files.apply(changes)
        after = _check(sources, files)
        if len(changes) > 1 and _is_worse(after, found):
            files.texts, changes, keys = before, changes[:1], keys[:1]
            files.apply(changes)
            after = _check(sources, files)
        if _is_worse(after, found):
            files.texts = before
            refused.add((changes[0].code, changes[0].message))
        else:
            counts.update(keys)
            found = after
    changed = [key for key, source in files.before.items() if files.texts[key] != source.text]
    for key in changed:
        files.texts[key] = _in_style(files.before[key], files.texts[key])
    return Fixed(
        files=tuple(FixedFile(files.before[key], files.texts[key], counts[key]) for key in changed),
        left=tuple(_check(sources, files) if changed else found),
    )


def _is_worse(after: Sequence[Diagnostic], before: Sequence[Diagnostic]) -> bool:
    """Whether there are more errors; while a text cannot be read as a whole, only errors of that kind are counted."""
    prefix = _UNREADABLE if any(each.code.startswith(_UNREADABLE) for each in before) else "E"
    return sum(each.code.startswith(prefix) for each in after) > sum(each.code.startswith(prefix) for each in before)


def _check(sources: Sequence[SourceFile], files: _Files) -> list[Diagnostic]:
    report = Report()
    for source in sources:
        for diagnostic in check(files.read(source.name), files.read).report.diagnostics:
            report.add(diagnostic)
    return report.diagnostics


def _in_style(before: SourceFile, text: str) -> str:
    """The text after fixes, formatted if it was formatted before, or if formatting changes only fixed lines."""
    formatted = _formatted(text)
    if formatted is None or _formatted(before.text) == before.text:
        return text if formatted is None else formatted
    untouched = Counter(before.text.split("\n")) & Counter(text.split("\n"))
    return formatted if untouched <= Counter(formatted.split("\n")) else text


def _formatted(text: str) -> str | None:
    report = Report()
    tree = parse(SourceFile(name="", text=text), report)
    return None if report.has_errors else format_tree(tree)
