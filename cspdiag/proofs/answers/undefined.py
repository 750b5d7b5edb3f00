"""Answers to questions about processes that are not defined until their parameters have values."""

from __future__ import annotations

from collections.abc import Sequence

from cspdiag.proofs.answers.answer import Answer
from cspdiag.proofs.answers.question import Question
from cspdiag.proofs.diagnostics.processes import OpenParameters
from cspdiag.syntax.ast import Parameter


def without_values(question: Question, process: str, parameters: Sequence[Parameter]) -> Answer:
    """The answer to a question about a process that has no values for these parameters."""
    found = OpenParameters(
        question.span,
        process=process,
        parameters=tuple(parameter.name.text for parameter in parameters),
        declared=tuple(parameter.name.span for parameter in parameters),
    )
    return Answer(question, "unknown", None, found.message, 0.0, found=found)
