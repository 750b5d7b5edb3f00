"""Answers to what is asked of a program with many elements, as far as a few elements answer for all of them."""

from __future__ import annotations

import time
from collections.abc import Callable

from cspdiag.model.program import Program
from cspdiag.network.elaborate.definitions import Definitions
from cspdiag.network.elaborate.fewer.varying import Varying
from cspdiag.network.ir.network import CoreNetwork
from cspdiag.proofs.answers.answer import Answer
from cspdiag.proofs.answers.question import Question, expected_of, questions_of
from cspdiag.proofs.rules.many_elements import proved_for_many
from cspdiag.syntax import ast


def answers_at_once(
    program: Program, varying: Varying, process: str | None, few: Callable[[str], CoreNetwork | None]
) -> tuple[tuple[Question, ...], dict[Question, Answer]]:
    """The questions about a program, or about ``process``, and the answers to those that are proved for any number of
    elements; ``few`` gives the network of a process with few elements. Raises what ``few`` raises.
    """
    questions = questions_of(program, process)
    outermost = Definitions(program).outermost() if process is None else program.definitions.get(process)
    if not questions and isinstance(outermost, ast.ProcessDefinition):
        questions = expected_of(program, outermost.name.text)
    answers: dict[Question, Answer] = {}
    for question in questions:
        began = time.monotonic()
        if question.claim not in ("deadlock free", "livelock free"):
            continue
        network = few(question.process)
        found = network and proved_for_many(program, varying, question.process, question.claim, network)
        if found:
            answers[question] = Answer(question, "proved", found.method, found.reason, time.monotonic() - began)
    return questions, answers
