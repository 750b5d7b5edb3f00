"""Answers as diagnostics."""

from __future__ import annotations

from collections.abc import Iterable

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.proofs.answers.answer import Answer
from cspdiag.proofs.counterexamples.counterexample import Counterexample, Failure
from cspdiag.proofs.counterexamples.words import headline, listed
from cspdiag.proofs.diagnostics.answers import (
    CanDeadlock,
    CanLivelock,
    DoesNotRefine,
    MayNotTerminate,
    NotProved,
    Refutation,
)

_KINDS: dict[Failure, type[Refutation]] = {
    "deadlock": CanDeadlock,
    "knot": CanDeadlock,
    "livelock": CanLivelock,
    "no termination": MayNotTerminate,
    "refinement": DoesNotRefine,
}

_MOST_PLACES = 8


def diagnostic_of(answer: Answer) -> Diagnostic | None:
    """The diagnostic of an answer; None for a property that was proved."""
    question = answer.question
    if answer.outcome == "proved":
        return None
    if answer.found is not None:
        return answer.found
    if answer.counterexample is None:
        return NotProved(question.span, question.text, answer.reason, answer.candidate)
    found = answer.counterexample
    advice = _advice(answer)
    return _KINDS[found.failure](question.span, question.process, headline(found), _places(found), advice)


def _places(found: Counterexample) -> tuple[Label, ...]:
    """Where the processes wait that wait for each other; processes that wait at the same place in the text share a
    label.
    """
    in_ring = [entry for entry in found.waiting if entry.name in found.ring] or found.waiting
    names: dict[tuple[str, int, int], list[str]] = {}
    labels: dict[tuple[str, int, int], tuple[Span, str]] = {}
    for entry in in_ring:
        if entry.span is not None:
            key = (entry.span.file, entry.span.start, entry.span.end)
            names.setdefault(key, []).append(entry.name)
            labels.setdefault(key, (entry.span, entry.words))
    return tuple(
        Label(span, _sentence_of(names[key], words)) for key, (span, words) in list(labels.items())[:_MOST_PLACES]
    )


def _sentence_of(names: list[str], words: str) -> str:
    if len(names) == 1:
        return f"`{names[0]}` {words}"
    others = f"{len(names) - 1} more like it" if len(names) > 2 else f"`{names[1]}`"
    return f"`{names[0]}` {words}, and so {'do' if len(names) > 2 else 'does'} {others}"


def diagnostics_of(answers: Iterable[Answer]) -> list[Diagnostic]:
    """The diagnostics of all answers that have one."""
    return [found for answer in answers if (found := diagnostic_of(answer)) is not None]


def _advice(answer: Answer) -> str | None:
    """The changes that were proved to help, the smallest first; the lines that are removed and added, for a change of
    more than one line.
    """
    if not answer.suggestions:
        return _about_ends(answer)
    lines = ["proved after one of these changes:"]
    for suggestion in answer.suggestions:
        proved = "" if suggestion.proved_with is None else f": proved with `{suggestion.proved_with}` only"
        lines.append(f"{suggestion.words}{proved}")
        difference = suggestion.difference
        lines += [f"  {line}" for line in difference if len(difference) > 2]
    return "\n".join(lines)


def _about_ends(answer: Answer) -> str | None:
    """Advice if some process waits for others that have all ended."""
    waiting = () if answer.counterexample is None else answer.counterexample.waiting
    left = [entry for entry in waiting if entry.ended and entry.ended == entry.partners]
    if not left:
        return None
    ended = dict.fromkeys(name for entry in left for name in entry.ended)
    outlive = f"{listed(entry.name for entry in left[:_MOST_PLACES])} {'outlives' if len(left) == 1 else 'outlive'}"
    return f"{outlive} {listed(list(ended)[:_MOST_PLACES])}: let all of them end, or none"
