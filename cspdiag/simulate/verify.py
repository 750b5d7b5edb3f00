"""Counterexamples are believed when the program itself does what they say."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import replace

from cspdiag import pipeline
from cspdiag.analyses.counterexamples.encode import encoded
from cspdiag.analyses.proofs.verdict import Limits, Method
from cspdiag.analyses.transitions import transition_system
from cspdiag.analyses.transitions.system import System
from cspdiag.analyses.verification.answer import Answer
from cspdiag.analyses.verification.prove import answered, not_replayed, prove
from cspdiag.analyses.verification.question import Question
from cspdiag.analyses.verification.schedulable import schedulable
from cspdiag.network.ir import Network
from cspdiag.simulate import spin
from cspdiag.simulate.replay import Replay, replay
from cspdiag.simulate.replay_trace import Trace, read_trace, trace_text


def trace_of(answer: Answer, settings: Mapping[str, str]) -> str:
    """The text of the file that ``run --replay`` takes; the answer has a counterexample."""
    assert answer.counterexample is not None
    left_open = list(dict.fromkeys(abstraction.what for abstraction in answer.abstractions))
    counterexample = encoded(answer.counterexample)
    return trace_text(counterexample, answer.question.process, answer.question.text, settings, left_open)


def replayed(network: Network, trace: Trace, read: pipeline.Reader) -> Replay:
    """The program of a network, stepped through a trace. Raises as ``pipeline.generate`` does."""
    return replay(network, pipeline.generate(network, read, level=0), trace)


class Verifier:
    """Answers what was asked of a program, with counterexamples that its code was stepped through.

    ``method`` is the only method of proof to be used; with ``spin``, SPIN looks for deadlocks. Its methods raise TransitionError, where a process has too
    many states of its own, and SpinError.
    """

    def __init__(
        self, asked: pipeline.Asked, read: pipeline.Reader, method: Method | None = None, *, spin: bool = False
    ) -> None:
        self._asked = asked
        self._read = read
        self._method = method
        self._spin = spin
        self._systems: dict[str, System] = {}

    def answer(self, question: Question, limits: Limits) -> Answer:
        """The answer to one of the questions."""
        if question.claim == "schedulable":
            network = self._asked.network(question.process)
            assert network is not None, "asked for a process with errors"
            return schedulable(question, network)
        if self._spin and question.claim == "deadlock free":
            answer = self._asked_spin(question, limits)
        else:
            answer = prove(question, self._system, limits, self._method)
        return self._confirmed(answer)

    def _system(self, process: str) -> System:
        if process not in self._systems:
            network = self._asked.network(process)
            assert network is not None, "asked for a process with errors"
            self._systems[process] = transition_system(network)
        return self._systems[process]

    def _asked_spin(self, question: Question, limits: Limits) -> Answer:
        began = time.monotonic()
        system = self._system(question.process)
        return answered(question, system, spin.deadlock_free(system, limits), "deadlock", time.monotonic() - began)

    def _confirmed(self, answer: Answer) -> Answer:
        """The answer with its counterexample replayed; unknown where the program does not follow it."""
        if answer.counterexample is None:
            return answer
        network = self._asked.network(answer.question.process)
        assert network is not None, "asked for a process with errors"
        result = replayed(network, read_trace(trace_of(answer, {})), self._read)
        if result.divergence is not None:
            return not_replayed(answer, result.divergence)
        return replace(answer, replayed=True)
