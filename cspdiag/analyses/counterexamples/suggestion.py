"""Changes of the text that may remove a deadlock, the least first."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from cspdiag.analyses.counterexamples.counterexample import Counterexample, Waiting
from cspdiag.diagnostics import Span
from cspdiag.diagnostics.record import field_names, is_record
from cspdiag.model.program import Program
from cspdiag.network.ir import Network
from cspdiag.syntax import ast


@dataclass(frozen=True)
class Suggestion:
    """A change: ``words`` say what to do, ``replacement`` is the new text of ``span``."""

    words: str
    span: Span
    replacement: str

    @property
    def text(self) -> str:
        """The whole file after the change."""
        whole = self.span.source.text
        return whole[: self.span.start] + self.replacement + whole[self.span.end :]


def suggestions(found: Counterexample, program: Program, network: Network) -> Iterator[Suggestion]:
    """What could be tried about processes that wait for each other; whether it helps is for a proof to say.

    First another order of two steps, then both at the same time, then a buffer in a channel.
    """
    waiting = [entry for entry in found.waiting if entry.name in found.ring] or list(found.waiting)
    neighbours = list(_neighbours(program, waiting))
    yield from (_exchanged(first, second) for first, second in neighbours)
    yield from (_parallel(first, second) for first, second in neighbours)
    yield from _buffered(program, network, waiting)


def _neighbours(program: Program, waiting: Sequence[Waiting]) -> Iterator[tuple[ast.Composition, ast.Composition]]:
    """Steps at which somebody waits, each with what comes directly after or before it."""
    known: set[tuple[str, int]] = set()
    for entry in waiting:
        if entry.span is None:
            continue
        for sequence in _sequences(program, entry.span):
            steps = sequence.processes
            at = next(index for index, step in enumerate(steps) if _covers(step.span, entry.span))
            for first, second in ((at, at + 1), (at - 1, at)):
                key = (entry.span.file, steps[max(first, 0)].span.start)
                if first >= 0 and second < len(steps) and key not in known:
                    known.add(key)
                    yield steps[first], steps[second]


def _sequences(program: Program, place: Span) -> list[ast.Sequence]:
    """The sequences one of whose steps is, or contains, a place; the innermost first."""
    found: list[ast.Sequence] = []
    pending: list[object] = [tree.items for tree in program.trees if tree.source is place.source]
    while pending:
        part = pending.pop()
        if isinstance(part, tuple):
            pending += part
        elif is_record(part) and not isinstance(part, Span):
            span = getattr(part, "span", None)
            if isinstance(span, Span) and not _covers(span, place):
                continue
            if isinstance(part, ast.Sequence) and any(_covers(step.span, place) for step in part.processes):
                found.append(part)
            pending += [getattr(part, name) for name in field_names(part)]
    return sorted(found, key=lambda sequence: sequence.span.end - sequence.span.start)


def _covers(outer: Span, inner: Span) -> bool:
    return outer.source is inner.source and outer.start <= inner.start and inner.end <= outer.end


def _range(first: ast.Composition, second: ast.Composition) -> tuple[Span, str]:
    """From the beginning of a step to the end of the next, and what stands between them."""
    source = first.span.source
    return Span(source, first.span.start, second.span.end), source.text[first.span.end : second.span.start]


def _exchanged(first: ast.Composition, second: ast.Composition) -> Suggestion:
    span, between = _range(first, second)
    words = f"`{_short(second)}` before `{_short(first)}` ({first.span})"
    return Suggestion(words, span, f"{second.span.text}{between}{first.span.text}")


def _parallel(first: ast.Composition, second: ast.Composition) -> Suggestion:
    span, _ = _range(first, second)
    words = f"`{_short(first)}` and `{_short(second)}` at the same time: join them by `||` ({first.span})"
    return Suggestion(words, span, f"({first.span.text} || {second.span.text})")


def _short(step: ast.Composition) -> str:
    text = " ".join(step.span.text.split())
    return text if len(text) <= 40 else f"{text[:38]} …"


def _buffered(program: Program, network: Network, waiting: Sequence[Waiting]) -> Iterator[Suggestion]:
    spans = {net.path: net.span for net in network.nets if net.external is None and net.kind == "sync"}
    known: set[int] = set()
    for entry in waiting:
        for channel in entry.channels if "to write" in entry.words else ():
            span = spans.get(channel)
            if span is not None and span.start not in known:
                known.add(span.start)
                yield from (_with_buffer(node) for node in _declarations(program, span))


def _declarations(program: Program, place: Span) -> Iterator[ast.Connection | ast.Channel]:
    """The declaration of a channel that belongs to a place."""
    pending: list[object] = [tree.items for tree in program.trees if tree.source is place.source]
    while pending:
        part = pending.pop()
        if isinstance(part, tuple):
            pending += part
        elif isinstance(part, ast.Connection | ast.Channel):
            if part.kind is None and (_covers(part.span, place) or _covers(place, part.span)):
                yield part
        elif isinstance(part, ast.ProcessDefinition | ast.Communication | ast.RepeatedDeclarations) and _covers(
            part.span, place
        ):
            pending += [getattr(part, name) for name in field_names(part)]


def _with_buffer(node: ast.Connection | ast.Channel) -> Suggestion:
    if isinstance(node, ast.Connection) and node.label is None and node.type is None:
        at, inserted = node.sinks[0].span.start, "buffer 1 -> "
    else:
        after = node.type or (node.label if isinstance(node, ast.Connection) else node.name)
        assert after is not None
        at, inserted = after.span.end, " buffer 1"
    text, place = node.span.text, at - node.span.start
    changed = f"{text[:place]}{inserted}{text[place:]}"
    words = f"a buffer in the channel: `{' '.join(changed.split())}` ({node.span})"
    return Suggestion(words, node.span, changed)
