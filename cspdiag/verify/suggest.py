"""Changes of the text that remove a deadlock, each proved to do so before it is suggested."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator, Mapping
from itertools import islice

from cspdiag import pipeline
from cspdiag.base import Report, SourceFile
from cspdiag.base.record import record, replaced
from cspdiag.network.lower.program import SelectionError
from cspdiag.obligations import ProofObligations, proof_obligations
from cspdiag.proofs.answers.answer import Answer
from cspdiag.proofs.answers.prove import prove
from cspdiag.proofs.answers.question import Question
from cspdiag.proofs.counterexamples.counterexample import Counterexample
from cspdiag.proofs.counterexamples.suggestion import Suggestion
from cspdiag.proofs.counterexamples.suggestions import suggestions
from cspdiag.proofs.verdict import Limits
from cspdiag.settings import SettingError
from cspdiag.syntax.format.formatter import format_tree
from cspdiag.syntax.parser import parse
from cspdiag.verify.systems import SystemCache, VerificationError

MOST_SUGGESTIONS = 4
MOST_OF_A_KIND = 2
MOST_TRIED = 24
SECONDS = 15.0 if sys.platform == "emscripten" else 3.0
"""The processor time for trying all changes together, and again the same time for a program that is not small: what is
suggested does not depend on the load of the machine. In a browser Python is several times slower, and its clock counts
whatever time passes.
"""
SMALL = 8
"""In a program with more instances, changes are first tried with a smaller constant, if the program then waits at the
same places.
"""
SMALLER = range(3, 9)
"""Values of constants that make a program small; a circle of two is not an example for larger ones."""


@record
class Deadlock:
    """A program with its settings, the question about it, and how it gets stuck."""

    obligations: ProofObligations
    question: Question
    found: Counterexample
    settings: Mapping[str, str]


def helpful(deadlock: Deadlock, read: pipeline.Reader, within: Limits) -> tuple[Suggestion, ...]:
    """Changes of the text after which the property was proved, the smallest first; the limits ``within`` are not
    exceeded.
    """
    network = deadlock.obligations.network(deadlock.question.process)
    if network is None or not deadlock.found.waiting:
        return ()
    limits = _for_changes(within)
    if len(network.instances) <= SMALL:
        return tuple(_proved(deadlock, read, limits))
    found = _smaller(deadlock, read, limits)
    if found is None:
        return tuple(_proved(deadlock, read, limits))
    smaller, proved_with = found
    helping = list(_proved(smaller, read, limits))
    limits = _for_changes(within)
    return tuple(
        suggestion if _helps(suggestion, deadlock, read, limits) else replaced(suggestion, proved_with=proved_with)
        for suggestion in helping
    )


def _for_changes(within: Limits) -> Limits:
    return Limits(min(SECONDS, within.remaining), within.memory, time.process_time)


def _proved(deadlock: Deadlock, read: pipeline.Reader, limits: Limits) -> Iterator[Suggestion]:
    program, network = deadlock.obligations.checked.program, deadlock.obligations.network(deadlock.question.process)
    assert program is not None
    assert network is not None
    helping = tried = 0
    for kind in suggestions(deadlock.found, program, network):
        of_kind = 0
        for suggestion in islice(kind, MOST_TRIED - tried):
            tried += 1
            if limits.remaining <= 0 or helping == MOST_SUGGESTIONS:
                return
            if _helps(suggestion, deadlock, read, limits):
                helping, of_kind = helping + 1, of_kind + 1
                yield _in_style(suggestion)
            if of_kind == MOST_OF_A_KIND:
                break


def _helps(suggestion: Suggestion, deadlock: Deadlock, read: pipeline.Reader, limits: Limits) -> bool:
    """Whether the property is proved once the text is changed."""
    changed = suggestion.span.source.name

    def read_changed(path: str) -> SourceFile:
        return SourceFile(name=path, text=suggestion.text) if path == changed else read(path)

    assert deadlock.obligations.checked.program is not None
    main = deadlock.obligations.checked.program.main.source
    source = read_changed(changed) if main.name == changed else main
    obligations = _obligations(source, read_changed, deadlock, deadlock.settings)
    answer = None if obligations is None else _answer(obligations, limits)
    return answer is not None and answer.outcome == "proved"


def _obligations(
    source: SourceFile, read: pipeline.Reader, deadlock: Deadlock, settings: Mapping[str, str]
) -> ProofObligations | None:
    """The same question about another program; None if that has errors."""
    question, real = deadlock.question, deadlock.obligations.checked.real
    try:
        obligations = proof_obligations(source, read, process=question.process, settings=settings, real=real)
    except (SettingError, SelectionError):
        return None
    same = tuple(other for other in obligations.questions if other.text == question.text)
    if not same or obligations.checked.report.has_errors or obligations.network(question.process) is None:
        return None
    return replaced(obligations, questions=same[:1])


def _answer(obligations: ProofObligations, limits: Limits) -> Answer | None:
    (question,) = obligations.questions
    if question in obligations.answers:
        return obligations.answers[question]
    if limits.remaining <= 0:
        return None
    try:
        return prove(question, SystemCache(obligations).of, limits.part(limits.remaining))
    except VerificationError:
        return None


def _smaller(deadlock: Deadlock, read: pipeline.Reader, limits: Limits) -> tuple[Deadlock, str] | None:
    """The same program with a smaller constant, with which it waits at the same places, and that setting; None if there
    is none.
    """
    program, network = deadlock.obligations.checked.program, deadlock.obligations.network(deadlock.question.process)
    assert program is not None
    assert network is not None
    for constant, value in program.constants.items():
        for less in SMALLER:
            if limits.remaining <= 0 or not isinstance(value, int) or less >= value:
                break
            settings = {**deadlock.settings, constant.name.text: str(less)}
            obligations = _obligations(program.main.source, read, deadlock, settings)
            small = None if obligations is None else obligations.network(deadlock.question.process)
            if obligations is None or small is None or len(small.instances) >= len(network.instances):
                break
            answer = _answer(obligations, limits)
            found = None if answer is None else answer.counterexample
            if found is not None and _places(found) == _places(deadlock.found):
                return Deadlock(obligations, obligations.questions[0], found, settings), f"{constant.name.text}={less}"
    return None


def _places(found: Counterexample) -> set[tuple[str, int]]:
    """The places of the text at which the processes wait."""
    return {(entry.span.file, entry.span.start) for entry in found.waiting if entry.span is not None}


def _in_style(suggestion: Suggestion) -> Suggestion:
    """The change as formatted by ``cspdiag fmt`` if the file itself is formatted so."""
    source = suggestion.span.source
    if _formatted(source) != source.text:
        return suggestion
    return suggestion.in_text(_formatted(SourceFile(name=source.name, text=suggestion.text)))


def _formatted(source: SourceFile) -> str:
    return format_tree(parse(source, Report()))
