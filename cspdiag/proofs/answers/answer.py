"""Answers to questions about processes."""

from __future__ import annotations

from typing import Literal, TypeAlias

from cspdiag.base import Diagnostic
from cspdiag.base.record import record
from cspdiag.proofs.answers.question import Question
from cspdiag.proofs.counterexamples.counterexample import Counterexample
from cspdiag.proofs.counterexamples.suggestion import Suggestion
from cspdiag.proofs.transitions.systems.system import Abstraction
from cspdiag.proofs.verdict import Method

Outcome: TypeAlias = Literal["proved", "refuted", "unknown"]

MOST_SHOWN = 6
"""Of what a proof leaves open no more than these are listed; a large array leaves something open for each element."""


@record
class Answer:
    """A verdict on a question, with the evidence for it.

    ``reason`` is a sentence: why the property holds, or why nothing is known. ``candidate`` describes, line by line, a
    state that could not be excluded. ``abstractions`` are what the transition system leaves open; ``replayed`` says
    whether the program itself was stepped through the counterexample.
    """

    question: Question
    outcome: Outcome
    method: Method | None
    reason: str
    seconds: float
    states: int | None = None
    counterexample: Counterexample | None = None
    candidate: tuple[str, ...] = ()
    abstractions: tuple[Abstraction, ...] = ()
    suggestions: tuple[Suggestion, ...] = ()
    replayed: bool = False
    found: Diagnostic | None = None
    """The diagnostic of an analysis that explores no states; None for the other methods."""
