"""Answers as JSON."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from cspdiag.base.render.json import place
from cspdiag.proofs.answers.answer import Answer
from cspdiag.proofs.answers.findings import diagnostic_of
from cspdiag.proofs.counterexamples.encode import encoded
from cspdiag.proofs.counterexamples.suggestion import Suggestion


def render(answers: Sequence[Answer]) -> str:
    """A list with an object for each question; ``verdict`` is ``proved``, ``refuted`` or ``unknown``; times are in
    seconds.
    """
    return json.dumps([_object(answer) for answer in answers], indent=2) + "\n"


def _object(answer: Answer) -> dict[str, Any]:
    question = answer.question
    found = diagnostic_of(answer)
    span = question.span
    return {
        "assertion": question.text,
        "process": question.process,
        "property": question.claim,
        "asserted": question.asserted,
        "verdict": answer.outcome,
        "code": None if found is None else found.code,
        "message": answer.reason if found is None else found.words.message,
        "method": answer.method,
        "states": answer.states,
        "seconds": round(answer.seconds, 6),
        **place(span),
        "candidate": list(answer.candidate),
        "abstractions": [
            {"what": abstraction.what, **({} if abstraction.span is None else place(abstraction.span))}
            for abstraction in answer.abstractions
        ],
        "suggestions": [_suggested(suggestion) for suggestion in answer.suggestions],
        "counterexample": None if answer.counterexample is None else encoded(answer.counterexample),
        "replayed": answer.replayed,
    }


def _suggested(suggestion: Suggestion) -> dict[str, Any]:
    """The change of a range of the text, whose end is exclusive; ``proved_with`` is null if the property was proved for
    the program at its full size.
    """
    span = suggestion.span
    return {
        "words": suggestion.words,
        **place(span),
        "end_line": span.end_line,
        "end_column": span.end_column,
        "replacement": suggestion.replacement,
        "proved_with": suggestion.proved_with,
    }
