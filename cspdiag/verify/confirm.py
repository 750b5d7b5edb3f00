"""Confirms counterexamples: the program itself must be able to follow them."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager
from itertools import islice
from typing import TYPE_CHECKING, TypeAlias

from cspdiag import pipeline
from cspdiag.base.record import replaced
from cspdiag.base.render.snippet import on_one_line
from cspdiag.obligations import ProofObligations
from cspdiag.proofs.answers.answer import Answer
from cspdiag.proofs.answers.prove import answered, not_followed, not_replayed, prove
from cspdiag.proofs.answers.question import Property, Question
from cspdiag.proofs.transitions.classes.distinguished import AsSpecification
from cspdiag.proofs.verdict import LimitError, Limits, Method
from cspdiag.verify.alarm import ended_by_alarm
from cspdiag.verify.systems import SystemCache, VerificationError

if TYPE_CHECKING:
    from cspdiag.model.types import Real
    from cspdiag.network.ir.network import CoreNetwork
    from cspdiag.proofs.counterexamples.counterexample import Counterexample
    from cspdiag.proofs.transitions.classes.distinguished import Distinguished
    from cspdiag.proofs.transitions.systems.system import System
    from cspdiag.verify.other_counterexamples import Narrowing
    from cspdiag.verify.replay.result import Judge, Replay
    from cspdiag.verify.runs.trace import Trace


Enforced: TypeAlias = Callable[[Limits], AbstractContextManager[object]]
"""Ends what is done inside it with LimitError when the time is up."""


def trace_of(answer: Answer, settings: Mapping[str, str], real: Real = "double") -> str:
    """The text of the file that ``run --replay`` takes; the answer has a counterexample."""
    from cspdiag.proofs.counterexamples.encode import encoded
    from cspdiag.verify.runs.trace import trace_text

    assert answer.counterexample is not None
    left_open = list(dict.fromkeys(abstraction.what for abstraction in answer.abstractions))
    counterexample = encoded(answer.counterexample)
    question = answer.question
    return trace_text(counterexample, question.process, question.text, settings, left_open, question.hidden, real)


def replayed(network: CoreNetwork, trace: Trace, read: pipeline.Reader) -> Replay:
    """Steps the program of a network through a trace. Raises LimitError, and as ``pipeline.generate`` does."""
    from cspdiag.verify.replay.attempts import replay

    return replay(network, pipeline.generate(network, read, level=0), trace, exactly=True)


class Verifier:
    """Answers the questions about a program, with counterexamples through which its code was stepped.

    ``settings`` are those of the questions. ``method`` is the only method of proof to be used; with ``spin``, SPIN
    looks for deadlocks. ``enforced`` ends an answer (proof, replay and suggestions) when its time is up.
    """

    def __init__(
        self,
        obligations: ProofObligations,
        read: pipeline.Reader,
        method: Method | None = None,
        *,
        spin: bool = False,
        settings: Mapping[str, str] | None = None,
        enforced: Enforced = ended_by_alarm,
    ) -> None:
        self._obligations = obligations
        self._read = read
        self._method = method
        self._spin = spin
        self._settings = settings
        self._enforced = enforced
        self._systems = SystemCache(obligations)
        self._files: dict[str, dict[str, str]] = {}

    def answer(self, question: Question, limits: Limits) -> Answer:
        """The answer to one of the questions.

        Raises VerificationError if a process alone has too many states, if SPIN is missing, or if the code cannot be
        run through a counterexample; OSError for a file of the program that cannot be read.
        """
        known = self._obligations.answers.get(question)
        if known is not None:
            return known
        began = time.monotonic()
        try:
            with self._enforced(limits):
                answer = self._answered(question, limits)
        except LimitError as stop:
            answer = Answer(question, "unknown", self._method, str(stop), 0.0)
        return replaced(answer, seconds=time.monotonic() - began)

    def _answered(self, question: Question, limits: Limits) -> Answer:
        if question.claim == "schedulable":
            from cspdiag.proofs.answers.schedulable import schedulable

            network = self._obligations.network(question.process)
            assert network is not None, "asked for a process with errors"
            return schedulable(question, network)
        if self._spin and question.claim == "deadlock free":
            answer = self._answer_by_spin(question, limits)
        else:
            answer = prove(question, self._systems.of, limits, self._method)
        answer = self._unless_guards_are_met(answer)
        confirmed = self._confirmed(answer, limits)
        if answer.counterexample is not None and confirmed.outcome == "unknown":
            try:
                return self._other_counterexample(answer.counterexample, question, limits) or confirmed
            except LimitError:
                return confirmed
        return self._with_suggestions(confirmed, limits)

    def _unless_guards_are_met(self, answer: Answer) -> Answer:
        """The answer, but no proof of a program in which the body of an interrupt may communicate with its guard: one
        thread has both ends then, and in a transition system offers of one thread do not meet.
        """
        from cspdiag.proofs.transitions.classes.own_guards import guard_met_by_its_body

        if answer.outcome == "proved":
            for process in answer.question.processes:
                network = self._obligations.network(process)
                interrupt = None if network is None else guard_met_by_its_body(network)
                if interrupt is not None:
                    place = f"{on_one_line(interrupt.span.file.rpartition('/')[2])}:{interrupt.span.line}"
                    what = f"the body of the interrupt in {place} may communicate with its guard"
                    reason = f"{what}, which proofs do not follow"
                    return replaced(answer, outcome="unknown", reason=reason)
        return answer

    def _other_counterexample(self, found: Counterexample, question: Question, limits: Limits) -> Answer | None:
        """The answer with another counterexample that the program follows, as it does not follow the one that was
        found.
        """
        from cspdiag.verify.other_counterexamples import MOST, in_whole_system, narrower

        for narrowing in islice(narrower(found), MOST):

            def narrowed(
                process: str,
                distinguished: Distinguished | None = None,
                specification: AsSpecification | None = None,
                narrowing: Narrowing = narrowing,
            ) -> System:
                whole = self._systems.of(process, distinguished, specification)
                return narrowing(whole) if specification is None else whole

            if limits.remaining <= 0:
                break
            rest = Limits(limits.remaining, limits.memory)
            answer = prove(question, narrowed, rest, self._method)
            if answer.counterexample is None:
                continue
            other = in_whole_system(answer.counterexample, self._systems.of(question.process))
            answer = self._confirmed(replaced(answer, counterexample=other), rest)
            if answer.outcome == "refuted":
                return self._with_suggestions(answer, limits)
        return self._non_termination(question, limits) if question.claim == "terminates" else None

    def _non_termination(self, question: Question, limits: Limits) -> Answer | None:
        """A deadlock, a knot or a livelock, by which the process does not terminate."""
        claims: tuple[Property, ...] = ("deadlock free", "livelock free")
        for claim in claims:
            if limits.remaining <= 0:
                break
            rest = Limits(limits.remaining, limits.memory)
            answer = self._confirmed(prove(replaced(question, claim=claim), self._systems.of, rest, self._method), rest)
            if answer.outcome != "refuted" or answer.counterexample is None:
                continue
            found = answer.counterexample
            if found.failure == "knot" and self._may_fail(question.process):
                continue  # What others do next may end the program, and the knot with it.
            without_end = replaced(found, failure="no termination") if claim == "livelock free" else found
            return replaced(answer, question=question, counterexample=without_end)
        return None

    def _may_fail(self, process: str) -> bool:
        """Whether some computation may end in a fault, or a sample may be missed."""
        from cspdiag.proofs.transitions.classes.faults import Faults

        network = self._obligations.network(process)
        assert network is not None, "asked for a process with errors"
        has_samples = any(port.direction == "in" and port.sampling is not None for port in network.external_ports)
        return has_samples or Faults(network).of_network()

    def _answer_by_spin(self, question: Question, limits: Limits) -> Answer:
        from cspdiag.verify import spin

        began = time.monotonic()
        system = self._systems.of(question.process)
        try:
            verdict = spin.deadlock_free(system, limits)
        except spin.SpinError as problem:
            raise VerificationError(str(problem)) from problem
        return answered(question, system, verdict, "deadlock", time.monotonic() - began)

    def _confirmed(self, answer: Answer, limits: Limits) -> Answer:
        """The answer with its counterexample replayed; unknown if the program does not follow it."""
        found = answer.counterexample
        if found is None:
            return answer
        from cspdiag.codegen import target_errors
        from cspdiag.simulate.run.execute import BodyError
        from cspdiag.verify.guided.account import with_steps_of
        from cspdiag.verify.replay.account import as_replayed
        from cspdiag.verify.replay.attempts import replay
        from cspdiag.verify.runs.names import in_words
        from cspdiag.verify.runs.trace import read_trace

        network = self._obligations.network(answer.question.process)
        assert network is not None, "asked for a process with errors"
        try:
            judge = self._judge(answer, network, limits)
            files = self._generated(answer.question.process, network)
            result = replay(network, files, read_trace(trace_of(answer, {})), judge, limits)
            if result.other:
                system = self._systems.of(answer.question.process)
                other = with_steps_of(found, system, result.other, result.standing, network, result.other_round_from)
                trace = read_trace(trace_of(replaced(answer, counterexample=other), {}))
                again = replay(network, files, trace, judge, limits)
                found, result = (other, again) if again.succeeded else (found, result)
        except (BodyError, target_errors()) as problem:
            raise VerificationError(str(problem)) from problem
        except LimitError as stop:
            return not_replayed(answer, stop)
        if result.divergence is not None:
            return not_followed(answer, in_words(result.divergence, network.top))
        found = as_replayed(found, result, network, self._systems.of(answer.question.process))
        found = replaced(found, reason=result.judgement or found.reason)
        return replaced(answer, replayed=True, counterexample=found)

    def _with_suggestions(self, answer: Answer, limits: Limits) -> Answer:
        """The refutation with changes of the text after which the property was proved, as far as there is time to look
        for them.
        """
        if answer.outcome != "refuted" or answer.counterexample is None:
            return answer
        from cspdiag.verify.suggest import Deadlock, helpful

        deadlock = Deadlock(self._obligations, answer.question, answer.counterexample, self._settings or {})
        try:
            return replaced(answer, suggestions=helpful(deadlock, self._read, limits))
        except LimitError:
            return answer

    def _generated(self, process: str, network: CoreNetwork) -> dict[str, str]:
        """The package of a process, for all its counterexamples. Raises as ``pipeline.generate`` does."""
        if process not in self._files:
            self._files[process] = pipeline.generate(network, self._read, level=0)
        return self._files[process]

    def _judge(self, answer: Answer, network: CoreNetwork, limits: Limits) -> Judge | None:
        """The judge of whether a run refines the specification in question; None for other questions."""
        specification = answer.question.specification
        if specification is None:
            return None
        from cspdiag.verify.replay.refinement import judge

        role = AsSpecification(frozenset(answer.question.free))
        return judge(answer.question, lambda values: self._systems.of(specification, values, role), network, limits)
