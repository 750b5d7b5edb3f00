"""Answers questions: chooses the proof, and turns its verdict into an answer."""

from __future__ import annotations

import time
from typing import Protocol

from cspdiag.base.record import replaced
from cspdiag.proofs.answers.answer import MOST_SHOWN, Answer
from cspdiag.proofs.answers.question import Question
from cspdiag.proofs.counterexamples.counterexample import Counterexample, Failure, counterexample
from cspdiag.proofs.transitions.classes.distinguished import AsSpecification, Distinction, Distinguished
from cspdiag.proofs.transitions.systems.system import Abstraction, System
from cspdiag.proofs.verdict import LimitError, Limits, Method, Proved, Refuted, Unknown, Verdict


class Systems(Protocol):
    """Makes transition systems of processes, each as the outermost process."""

    def __call__(
        self, process: str, distinguished: Distinguished | None = None, specification: AsSpecification | None = None
    ) -> System:
        """The transition system of the process with this name; see ``transition_system``."""


def prove(question: Question, systems: Systems, limits: Limits, method: Method | None = None) -> Answer:
    """The answer to a question; if ``method`` is given, only that method is used.

    Raises what ``systems`` raises. A limit that is reached makes the answer unknown.
    """
    began = time.monotonic()
    left_open: tuple[Abstraction, ...] = ()
    try:
        system, specification = _systems_of(question, systems)
        left_open = system.abstractions
        answer = _answer(question, system, specification, limits, method)
    except LimitError as limit:
        answer = Answer(question, "unknown", method, str(limit), 0.0)
    except MemoryError:
        answer = Answer(question, "unknown", method, "the memory of this machine is used up", 0.0)
    return replaced(answer, seconds=time.monotonic() - began, abstractions=(*left_open, *answer.abstractions))


def _systems_of(question: Question, systems: Systems) -> tuple[System, System | None]:
    """The systems of the process and of its specification, if it has one; both distinguish the same values of the
    inputs that the specification distinguishes.
    """
    if question.specification is None:
        return systems(question.process), None
    from cspdiag.proofs.refine.labels import Labels

    role = AsSpecification(frozenset(question.free))
    specification = systems(question.specification, None, role)
    ports = Labels(specification, question.unseen).distinguished
    system = systems(question.process, {port: specification.distinctions.get(port, Distinction()) for port in ports})
    both = {port: distinction for port, distinction in system.distinctions.items() if port in ports}
    return system, systems(question.specification, both, role)


def _answer(
    question: Question, system: System, specification: System | None, limits: Limits, method: Method | None
) -> Answer:
    match question.claim:
        case "deadlock free":
            return _deadlock_free(question, system, limits, method)
        case "livelock free":
            return _livelock_free(question, system, limits)
        case "terminates":
            return _terminates(question, system, limits)
        case "refines":
            assert specification is not None
            return _refines(question, system, specification, limits)
        case "schedulable":
            raise ValueError("timing is not a matter of transition systems")


def _deadlock_free(question: Question, system: System, limits: Limits, method: Method | None) -> Answer:
    """Whether there is neither a deadlock, in which no process continues, nor a knot, in which some processes wait for
    each other forever while others continue.
    """
    from cspdiag.proofs.portfolio import prove_deadlock_free, prove_knot_free
    from cspdiag.proofs.structure.pairs import Structure

    methods = None if method is None else (method,)
    structure = Structure(system, limits)
    deadlock = prove_deadlock_free(system, limits, methods, structure)
    if not isinstance(deadlock, Proved):
        return _verdict(question, system, deadlock, "deadlock")
    knot = prove_knot_free(system, limits, methods, structure)
    if not isinstance(knot, Proved):
        return _verdict(question, system, knot, "knot")
    reason = f"no deadlock ({deadlock.reason}) and no knot ({knot.reason})"
    if deadlock.reason == knot.reason:
        reason = f"no deadlock and no knot ({knot.reason})"
    states = max(deadlock.states or 0, knot.states or 0) or None
    return Answer(question, "proved", knot.method, reason, 0.0, states)


def _livelock_free(question: Question, system: System, limits: Limits) -> Answer:
    from cspdiag.proofs.properties.livelock import livelock_free

    return _verdict(question, system, livelock_free(system, limits), "livelock")


def _terminates(question: Question, system: System, limits: Limits) -> Answer:
    from cspdiag.proofs.properties.termination import terminates

    return _verdict(question, system, terminates(system, limits), "no termination")


def _refines(question: Question, system: System, specification: System, limits: Limits) -> Answer:
    from cspdiag.proofs.refine.refinement import refines_in_failures, refines_in_traces

    refines = refines_in_failures if question.model == "failures" else refines_in_traces
    verdict = refines(system, specification, limits, hidden=question.unseen)
    if isinstance(verdict, Proved) and specification.abstractions:
        return _weakly_proved(question, specification, verdict)
    return _verdict(question, system, verdict, "refinement")


def _weakly_proved(question: Question, specification: System, proved: Proved) -> Answer:
    """The answer if a process does only what the transition system of its specification allows, which may be more than
    the specification itself.
    """
    left_open = dict.fromkeys(
        abstraction.what if abstraction.span is None else f"{abstraction.what} ({abstraction.span})"
        for abstraction in specification.abstractions
    )
    reason = (
        f"no forbidden step of `{question.process}` was found, but the proof does not know all that "
        f"`{question.specification}` forbids: " + "; ".join(left_open)
    )
    return Answer(
        question, "unknown", proved.method, reason, 0.0, proved.states, abstractions=specification.abstractions
    )


def answered(question: Question, system: System, verdict: Verdict, failure: Failure, seconds: float) -> Answer:
    """The answer with a verdict from elsewhere."""
    answer = _verdict(question, system, verdict, failure)
    return replaced(answer, seconds=seconds, abstractions=system.abstractions)


def _verdict(question: Question, system: System, verdict: Verdict, failure: Failure) -> Answer:
    match verdict:
        case Proved():
            return Answer(question, "proved", verdict.method, verdict.reason, 0.0, verdict.states)
        case Refuted():
            found = counterexample(system, verdict, failure, question.process, verdict.reason)
            return Answer(question, "refuted", verdict.method, "", 0.0, verdict.states, found)
        case Unknown():
            candidate = _candidate(question, system, verdict)
            return Answer(question, "unknown", verdict.method, verdict.reason, 0.0, candidate=candidate)


def _candidate(question: Question, system: System, unknown: Unknown) -> tuple[str, ...]:
    """The state that could not be excluded: a line for each process that may be stuck in it."""
    if unknown.candidate is None:
        return ()
    lines = []
    for index in unknown.stuck or range(len(system.components)):
        component, state = system.components[index], unknown.candidate[index]
        place = component.places.get(state)
        if component.process and state not in component.terminal and place is not None:
            lines.append(
                f"`{component.name.removeprefix(f'{question.process}.')}` {place.words}"
                + ("" if place.span is None else f" ({place.span})")
            )
    return tuple(lines)


def not_followed(answer: Answer, divergence: str) -> Answer:
    """The answer if the program itself does not follow its counterexample."""
    return _unconfirmed(answer, f"the program does not follow it: {divergence}")


def not_replayed(answer: Answer, stop: LimitError) -> Answer:
    """The answer if a limit of time or memory was reached before its counterexample was replayed."""
    return _unconfirmed(answer, f"it was not replayed: {stop}")


def _unconfirmed(answer: Answer, but: str) -> Answer:
    found = answer.counterexample
    assert found is not None
    open_points = list(dict.fromkeys(abstraction.what for abstraction in answer.abstractions))
    left_open = "; ".join(open_points[:MOST_SHOWN])
    if len(open_points) > MOST_SHOWN:
        left_open += f"; and {len(open_points) - MOST_SHOWN} more"
    believed = f" ({found.reason})" if found.reason else ""
    reason = f"a counterexample was found{believed}, but {but}"
    if left_open:
        reason += f" (left open in the proof: {left_open})"
    return replaced(answer, outcome="unknown", reason=reason, counterexample=None, candidate=_supposed_lines(found))


def _supposed_lines(found: Counterexample) -> tuple[str, ...]:
    from cspdiag.proofs.counterexamples.words import supposed_lines

    return tuple(supposed_lines(found))
