"""Compares the answers of cspdiag for one program with the right ones."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from random import Random

from tests.oracle.explore import explore
from tests.oracle.judged import Judgement, verify
from tests.oracle.programs.closed import closed
from tests.oracle.programs.instants import single_steps, uses_the_time, with_instants, with_knot
from tests.oracle.programs.nested import is_nested, nested
from tests.oracle.programs.pairs import pair
from tests.oracle.programs.shrink import tidy
from tests.oracle.programs.text import process, text
from tests.oracle.programs.timed import timed
from tests.oracle.programs.tree import INT, MS, Program
from tests.oracle.properties import Answer, deadlock_free, livelock_free, schedulable, terminates
from tests.oracle.refine import refines
from tests.oracle.traces import compare_traces

WIDE = (-(2**63), -5, -2, -1, 0, 1, 2, 3, 4, 5, 7, 8, 100, 2**63 - 1)


@dataclass(frozen=True)
class Case:
    seed: int


@dataclass
class Outcome:
    counted: list[str] = field(default_factory=list)
    wrong: str = ""
    text: str = ""
    program: Program | None = None


@dataclass(frozen=True)
class Comparison:
    compare: Callable[[Case], Outcome]


def contradiction(judgement: Judgement, answer: Answer) -> str:
    """Why both answers cannot be right; empty if they can."""
    steps = "\n".join(f"//   {step}" for step in answer.run)
    if judgement.verdict == "crashed":
        return "cspdiag fails: " + judgement.text
    if judgement.verdict == "proved" and answer.holds is False:
        return f"PROVED ({judgement.text}), but {answer.why}:\n{steps}"
    if judgement.verdict == "refuted" and answer.holds is True:
        return f"REFUTED ({judgement.text}), but all {answer.states} states were looked at, and none fails"
    return ""


def judged(program: Program, printed: str, decide: Callable[[Program], Answer]) -> Outcome:
    """Query cspdiag after the oracle has answered, and not at all if the oracle has no answer.

    A proof is found at once or not at all, so there is little time if only a proof would be wrong. If cspdiag refutes
    what holds with few values at the inputs, the oracle tries again with more.
    """
    outcome = Outcome(text=printed, program=program)
    answer = decide(program)
    if answer.holds is None:
        outcome.counted.append("left open" if answer.why else "too large")
        return outcome
    judgement = verify(printed, seconds=3 if answer.holds else 0.5)
    outcome.counted.append(judgement.verdict)
    if judgement.verdict == "rejected":
        outcome.counted.append("rejected " + judgement.text.split("\n")[0])
    outcome.wrong = contradiction(judgement, answer)
    numbers = any(port.input and port.domain and port.type == INT for port in program.ports)
    if outcome.wrong and answer.holds and numbers and not decide(with_values(program, WIDE)).holds:
        outcome.counted.append("differs with more values")
        outcome.wrong = ""
    return outcome


def with_values(program: Program, domain: tuple[int, ...]) -> Program:
    """A program whose numeric inputs have more values."""
    ports = (
        replace(port, domain=domain) if port.input and port.domain and port.type == INT else port
        for port in program.ports
    )
    return replace(program, ports=tuple(ports))


def _deadlock(program: Program) -> Answer:
    return deadlock_free(explore(program))


def _terminates(program: Program) -> Answer:
    return terminates(explore(program))


def _livelock(program: Program) -> Answer:
    return livelock_free(explore(program))


def program_of(seed: int, *, inputs: bool) -> Program:
    """A closed program, or one with inputs; about one in six uses the present instant, and one in five has nested
    interrupts that meet.

    Those that use the present instant have no laws: in proofs a law may compute for any time, and here it takes no
    time.
    """
    if is_nested(seed):
        return nested(seed, inputs=inputs, sampled=inputs)
    if not uses_the_time(seed):
        return closed(seed, inputs=inputs)
    rng = Random(f"instants {seed}")
    base = single_steps(rng) if rng.random() < 0.6 else closed(seed, inputs=inputs, without=frozenset({"law"}))
    made = tidy(with_instants(base, rng))
    return with_knot(made) if Random(f"knot {seed}").random() < 0.1 else made


def _counted_separately(outcome: Outcome) -> Outcome:
    """Answers for programs that use the present instant, or have nested interrupts, are also counted separately."""
    if outcome.program is not None and "nested" in outcome.program.tags:
        outcome.counted += [f"nested: {name}" for name in outcome.counted]
        outcome.counted += ["nested"] + ["nested: wrong"] * bool(outcome.wrong)
    if "now" in outcome.text:
        outcome.counted += [f"now: {name}" for name in outcome.counted]
        outcome.counted += ["now"] + ["now: wrong"] * bool(outcome.wrong)
    return outcome


def _closed(assertion: str, decide: Callable[[Program], Answer]) -> Comparison:
    def compare(case: Case) -> Outcome:
        program = program_of(case.seed, inputs=case.seed % 3 == 0)
        outcome = judged(program, text(program, assertion), decide)
        return _counted_separately(outcome)

    return Comparison(compare)


def _timed(seed: int, *, outputs: bool = False) -> Program:
    if is_nested(seed):
        return replace(nested(seed, inputs=seed % 3 == 0, sampled=True), step=MS)
    program = timed(seed, outputs=outputs)
    if not uses_the_time(seed):
        return program
    return tidy(with_instants(program, Random(f"instants {seed}")))


def _schedulable(case: Case) -> Outcome:
    program = _timed(case.seed)

    def decide(program: Program) -> Answer:
        return schedulable(explore(program, free=False, wcet=True))

    return _counted_separately(judged(program, text(program, "schedulable"), decide))


def _trace(case: Case) -> Outcome:
    """Both levels of Python, and for one program in twenty C, which has to be compiled."""
    if case.seed % 3:
        program = replace(program_of(case.seed, inputs=case.seed % 3 == 1), step=500_000)
    else:
        program = _timed(case.seed, outputs=True)
    targets = ("-O0", "-O1", "C", "C -O1") if case.seed % 20 == 0 else ("-O0", "-O1")
    counted, wrong = compare_traces(program, 41_300_000, targets)
    return _counted_separately(Outcome(counted, wrong, text(program), program))


def _refines(case: Case) -> Outcome:
    made = pair(case.seed)
    their_text = "\n".join(process(made.specification))
    failures = case.seed % 3 == 0
    clauses = (" in failures" if failures else "") + (f" hide {', '.join(made.hidden)}" if made.hidden else "")
    printed = f"{text(made.program)}{their_text}\nassert Main refines Spec{clauses}\n"

    def decide(program: Program) -> Answer:
        domains = {port.name: port.domain for port in program.ports}
        ports = tuple(replace(port, domain=domains[port.name]) for port in made.specification.ports)
        specification = replace(made.specification, ports=ports)
        return refines(program, specification, failures=failures)

    outcome = judged(made.program, printed, decide)
    if made.holds:
        outcome.counted.append("holds by construction")
    outcome.counted += [clause for clause in ("in failures", "hide") if clause in clauses]
    return _counted_separately(outcome)


COMPARISONS = {
    "refines": Comparison(_refines),
    "trace": Comparison(_trace),
    "schedulable": Comparison(_schedulable),
    "deadlock": _closed("deadlock free", _deadlock),
    "livelock": _closed("livelock free", _livelock),
    "terminates": _closed("terminates", _terminates),
}
