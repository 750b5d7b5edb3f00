"""Changes of the composition diagram: steps in another order, at the same time, or as alternatives.

A loop in which a process both serves requests and makes them can close a cycle in a client-server network (Welch, Justo
and Willcock, "High-level paradigms for deadlock-free high-performance systems", 1993; Martin and Jassim, "How to design
deadlock-free networks using CSP and verification tools", 1997): instead, it may serve before it requests, or serve
requests whenever they arrive.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from cspdiag.base import Span
from cspdiag.model.program import Program
from cspdiag.proofs.counterexamples.suggestion import Suggestion
from cspdiag.proofs.counterexamples.surroundings import around, covers
from cspdiag.syntax import ast

Steps = Sequence[ast.Composition]


def exchanged(program: Program, places: Sequence[Span]) -> Iterator[Suggestion]:
    """Suggests moving a step at which a process waits after the next step, or before the previous one."""
    for first, second in _neighbours(program, places):
        yield _exchange((first,), (second,))


def parallel(program: Program, places: Sequence[Span]) -> Iterator[Suggestion]:
    """Suggests running a step at which a process waits in parallel with the step before or after it."""
    for first, second in _neighbours(program, places):
        words = f"`{_short(first)}` and `{_short(second)}` at the same time: join them by `||` ({first.span})"
        yield Suggestion(words, _range((first, second)), f"({first.span.text} || {second.span.text})")


def served_first(program: Program, places: Sequence[Span]) -> Iterator[Suggestion]:
    """Suggests running the second half of a loop in which a process waits before the first half; for loops of two steps
    ``exchanged`` suggests the same.
    """
    for _, first, second in _halves(program, places):
        if len(first) + len(second) > 2:
            yield _exchange(first, second)


def served_in_any_order(program: Program, places: Sequence[Span]) -> Iterator[Suggestion]:
    """Suggests making the two halves of an endless loop in which a process waits alternatives."""
    for loop, first, second in _halves(program, places):
        if isinstance(loop, ast.Mu) and loop.until is None:
            span = _range((*first, *second))
            separator = "\n[]\n" if "\n" in span.text else " [] "
            words = f"serve `{_short(first[0])}` and `{_short(second[0])}` in any order: join them by `[]` ({span})"
            yield Suggestion(words, span, f"{_guarded(first)}{separator}{_guarded(second)}")


def _neighbours(program: Program, places: Sequence[Span]) -> Iterator[tuple[ast.Composition, ast.Composition]]:
    """Pairs of neighbouring steps of a sequence, at one of which a process waits."""
    known: set[ast.Composition] = set()
    for place in places:
        for sequence in around(program, place, ast.Sequence):
            steps = sequence.processes
            at = next((index for index, step in enumerate(steps) if covers(step.span, place)), None)
            if at is None:
                continue
            for first, second in ((at, at + 1), (at - 1, at)):
                if first >= 0 and second < len(steps) and steps[first] not in known:
                    known.add(steps[first])
                    yield steps[first], steps[second]


def _halves(program: Program, places: Sequence[Span]) -> Iterator[tuple[ast.Mu | ast.While, Steps, Steps]]:
    """The loops in which a process waits and that begin with a communication, split before each
    further communication.
    """
    known: set[ast.Node] = set()
    for place in places:
        loops: list[ast.Mu | ast.While] = [*around(program, place, ast.Mu)]
        loops += around(program, place, ast.While)
        for loop in loops:
            if loop in known or not isinstance(loop.process, ast.Sequence):
                continue
            known.add(loop)
            steps = loop.process.processes
            for at in range(1, len(steps)) if _communicates(steps[0]) else ():
                if _communicates(steps[at]):
                    yield loop, steps[:at], steps[at:]


def _communicates(step: ast.Composition) -> bool:
    return isinstance(step, ast.Read | ast.Write)


def _range(steps: Steps) -> Span:
    return Span(steps[0].span.source, steps[0].span.start, steps[-1].span.end)


def _exchange(first: Steps, second: Steps) -> Suggestion:
    one, other = _range(first), _range(second)
    between = one.source.text[one.end : other.start]
    words = f"{_listed(second)} before {_listed(first)} ({one})"
    return Suggestion(words, Span(one.source, one.start, other.end), f"{other.text}{between}{one.text}")


def _guarded(steps: Steps) -> str:
    """Steps as a branch of an alternative: the first step is the guard."""
    guard, *rest = steps
    if not rest:
        return f"{guard.span.text} -> skip"
    text = _range(rest).text
    return f"{guard.span.text} -> {text if len(rest) == 1 else f'({text})'}"


def _listed(steps: Steps) -> str:
    texts = [f"`{_short(step)}`" for step in steps]
    if len(texts) > 3:
        return f"{texts[0]} … {texts[-1]}"
    return " ; ".join(texts)


def _short(step: ast.Composition) -> str:
    text = " ".join(step.span.text.split())
    return text if len(text) <= 40 else f"{text[:38]} …"
