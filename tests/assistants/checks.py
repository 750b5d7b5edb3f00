"""The checks of tasks, one per line. Any program that passes them is a solution, however it is written.

About the text and its proofs:

=========================================  ==============================================================
``keeps Motor, Bench``                     these definitions are as in the program to start from
``asserts Joint deadlock free``            the program has this assertion
``proves Joint deadlock free``             it holds, whether the program has it or not
``refutes Joint terminates``               it does not hold
``period of angle is 10 ms``               of a port of the outermost process
=========================================  ==============================================================

``run Bench for 3 s`` runs the program; ``, with T = 5 ms`` sets something before, ``, with k = 3 at 1 s`` changes a
parameter during the run. What follows is about the last run:

=========================================  ==============================================================
``ends`` or ``ends at 2 s``                by itself
``continues``                              up to the limit of the run
``fails with Timeout``                     ends with an exception that is not caught
``misses nothing``                         takes each sample that a process follows
``force at 2 s is 0.5 +- 0.1``             the value of a port that was valid at this instant
``force is in -1 .. 1 from 1 s to 2 s``    all values in this time
``alarm comes at 200 ms, 400 ms``          the instants of all communications at a port
``force comes every 1 ms from 1 s to 2 s`` at each of these instants after the first
``alarm passes 1, 2, 3``                   the values of all communications at a port
``brake is released as true``              what an output is set to when the run ends
=========================================  ==============================================================
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import NamedTuple

import cspdiag
from cspdiag.base import Report, SourceFile
from cspdiag.syntax.format.formatter import format_tree
from cspdiag.syntax.parser import parse
from tests.assistants.tasks import Task, definitions

TIME_LIMIT = 20
"""Seconds for each proof."""
_UNITS = {"us": 10**3, "ms": 10**6, "s": 10**9}


class FailedCheckError(Exception):
    """A check that an attempt does not pass, and why."""

    def __init__(self, check: str, reason: str) -> None:
        super().__init__(f"{check}: {reason}")
        self.check = check
        self.reason = reason


class Attempt:
    """A program that is judged, and its last run."""

    def __init__(self, task: Task, text: str) -> None:
        self.task = task
        self.text = text
        self.whole = f"{text}\n{task.judge}"
        self.found: list[cspdiag.Diagnostic] = cspdiag.parse(text, name="attempt.csp").check()
        self.last: cspdiag.Run | None = None

    @property
    def run(self) -> cspdiag.Run:
        assert self.last is not None, "a check of a run comes after a line `run ...`"
        return self.last


def judge(task: Task, text: str) -> FailedCheckError | None:
    """The first check of a task that an attempt fails; None if it passes all."""
    line = "no errors"
    try:
        attempt = Attempt(task, text)
        _refuse_errors(attempt.found, "no errors")
        _refuse_errors(cspdiag.parse(attempt.whole, name="attempt.csp").check(), "fits its surroundings")
        for line in task.checks:
            check, words = _check_of(line)
            wrong = check(attempt, *words)
            if wrong:
                return FailedCheckError(line, wrong)
    except FailedCheckError as failure:
        return failure
    except cspdiag.CspdiagError as problem:
        return FailedCheckError(line, str(problem))
    return None


def _refuse_errors(found: list[cspdiag.Diagnostic], check: str) -> None:
    for diagnostic in found:
        if diagnostic.severity == "error":
            raise FailedCheckError(
                f"{check}: {diagnostic.code}" if check == "no errors" else check,
                f"line {diagnostic.span.line}: {diagnostic.code} {diagnostic.message}",
            )


def _check_of(line: str) -> tuple[Callable[..., str], list[str]]:
    for pattern, check in _CHECKS.items():
        found = re.fullmatch(pattern, line)
        if found:
            return check, [word or "" for word in found.groups()]
    raise ValueError(f"there is no check `{line}`")


def instant(text: str) -> int:
    """Nanoseconds of a duration such as ``200 ms``."""
    number, unit = text.split()
    return round(float(number) * _UNITS[unit])


class _Range(NamedTuple):
    lowest: float
    highest: float

    def __contains__(self, value: object) -> bool:
        return self.lowest <= float(str(value)) <= self.highest


# Checks of the text. Each returns what is wrong, or nothing.


def _keeps(attempt: Attempt, names: str) -> str:
    before, after = (
        {name.split()[-1]: each for name, each in _in_standard_format(text).items()}
        for text in (attempt.task.start, attempt.text)
    )
    changed = [name for name in names.split(", ") if before[name] != after.get(name)]
    return f"{', '.join(changed)} should be as it was" if changed else ""


def _in_standard_format(text: str) -> dict[str, str]:
    """The definitions of a program without comments."""
    tree = parse(SourceFile(name="attempt.csp", text=text), Report())
    without_comments = re.sub(r"^\s*//.*\n", "", format_tree(tree), flags=re.MULTILINE)
    return {name: each.strip() for name, each in definitions(without_comments).items()}


def _asserts(attempt: Attempt, claim: str) -> str:
    definitions_of_it = [" ".join(each.split()) for each in _in_standard_format(attempt.text).values()]
    return "" if f"assert {claim}" in definitions_of_it else "the program does not assert it"


def _proof(attempt: Attempt, claim: str, expected: str) -> str:
    text = f"{attempt.whole}\nassert {claim}\n"
    program = cspdiag.parse(text, name="attempt.csp")
    _refuse_errors(program.check(), "fits its surroundings")
    answers = program.verify(claim.split()[0], time_limit=TIME_LIMIT)
    answer = next(answer for answer in reversed(answers) if answer.question.text == claim)
    return "" if answer.outcome == expected else f"it is {answer.outcome}"


def _proves(attempt: Attempt, claim: str) -> str:
    return _proof(attempt, claim, "proved")


def _refutes(attempt: Attempt, claim: str) -> str:
    return _proof(attempt, claim, "refuted")


def _period(attempt: Attempt, port: str, period: str) -> str:
    for each in cspdiag.parse(attempt.whole, name="attempt.csp").network.external_ports:
        if each.key == port:
            actual = 0 if each.sampling is None else each.sampling.period
            return "" if actual == instant(period) else f"it is {actual / 1e6:g} ms"
    return "there is no such port"


# Checks of runs.


def _run(attempt: Attempt, environment: str, limit: str, name: str, value: str, when: str) -> str:
    program = cspdiag.parse(attempt.whole, name="attempt.csp")
    try:
        attempt.last = program.run(
            environment, until=limit, level=0, set={name: value} if name and not when else None,
            tune={when: {name: value}} if when else None,
        )  # fmt: skip
    except cspdiag.CspdiagError as problem:
        return next((line for line in str(problem).splitlines() if "error" in line), str(problem))
    return ""


def _ends(attempt: Attempt, when: str) -> str:
    outcome = attempt.run.outcome
    if outcome.ended != "terminated":
        return f"it ends otherwise: {attempt.run.summary().splitlines()[0]}"
    return "" if not when or outcome.time == instant(when) else f"it ends at {outcome.time / 1e6:g} ms"


def _continues(attempt: Attempt) -> str:
    return "" if attempt.run.outcome.ended == "time limit" else attempt.run.summary().splitlines()[0]


def _fails(attempt: Attempt, name: str) -> str:
    error = attempt.run.outcome.error
    return "" if error is not None and name in repr(error) else f"it does not: {attempt.run.outcome.ended}, {error!r}"


def _misses_nothing(attempt: Attempt) -> str:
    missed = [port for port, count in attempt.run.outcome.missed.items() if count]
    return f"it misses samples of {', '.join(missed)}" if missed else ""


def _values(attempt: Attempt, port: str) -> list[tuple[int, float | str]]:
    """The instants and values of a port, as numbers or as the names of literals."""
    if port not in attempt.run.signals:
        raise FailedCheckError(port, "there is no such port, or nothing was communicated there")
    signal = attempt.run.signals[port]
    return [(round(float(time) * 1e9), _plain(value)) for time, value in zip(signal.time, signal.value, strict=True)]


def _plain(value: object) -> float | str:
    text = str(value).rpartition(".")[2] if re.fullmatch(r"\w*[A-Za-z]\w*\.\w+", str(value)) else str(value)
    try:
        return float({"True": "1", "False": "0"}.get(text, text))
    except ValueError:
        return text


def _number(text: str) -> float | str:
    return _plain({"true": "True", "false": "False"}.get(text, text))


def _at(attempt: Attempt, port: str, when: str, expected: str, tolerance: str) -> str:
    earlier = [value for time, value in _values(attempt, port) if time <= instant(when)]
    actual = earlier[-1] if earlier else 0.0
    meant = _number(expected)
    if isinstance(actual, float) and isinstance(meant, float):
        return "" if abs(actual - meant) <= float(tolerance or 1e-9) else f"it is {actual:g}"
    return "" if actual == meant else f"it is {actual}"


def _within(attempt: Attempt, port: str, low: str, high: str, begin: str, end: str) -> str:
    allowed = _Range(float(low), float(high))
    values = _values(attempt, port)
    before = [value for time, value in values if time <= instant(begin)][-1:]
    inside = [value for time, value in values if instant(begin) < time < instant(end)]
    outside = [value for value in (before + inside) if value not in allowed]
    return f"it is {outside[0]}" if outside else ""


def _communications(attempt: Attempt, port: str) -> list[tuple[int, float | str]]:
    channel = f"{attempt.run.network.top}.{port}"
    return [(each.time, _plain(each.value)) for each in attempt.run.communications if each.channel == channel]


def _comes(attempt: Attempt, port: str, instants: str) -> str:
    expected = [instant(each) for each in instants.split(", ")] if instants != "no time" else []
    actual = [time for time, _ in _communications(attempt, port)]
    return "" if actual == expected else f"it comes at {', '.join(f'{time / 1e6:g} ms' for time in actual[:12])}"


def _comes_every(attempt: Attempt, port: str, period: str, begin: str, end: str) -> str:
    expected = set(range(instant(begin) + instant(period), instant(end) + 1, instant(period)))
    lost = expected - {time for time, _ in _communications(attempt, port)}
    return f"there is none at {min(lost) / 1e6:g} ms" if lost else ""


def _passes(attempt: Attempt, port: str, values: str) -> str:
    expected = [_number(each) for each in values.split(", ")]
    actual = [value for _, value in _communications(attempt, port)]
    return "" if actual == expected else f"it passes {', '.join(map(str, actual[:12]))}"


def _released(attempt: Attempt, port: str, value: str) -> str:
    channel = f"{attempt.run.network.top}.{port}"
    released = [_plain(each[2]) for each in attempt.run.releases if each[1] == channel]
    return "" if released == [_number(value)] else f"it is released as {released}"


_TIME = r"([\d.]+ (?:us|ms|s))"
_CHECKS: dict[str, Callable[..., str]] = {
    r"keeps (.+)": _keeps,
    r"asserts (.+)": _asserts,
    r"proves (.+)": _proves,
    r"refutes (.+)": _refutes,
    rf"period of (\S+) is {_TIME}": _period,
    rf"run (\w+) for {_TIME}(?:, with (\S+) = (.+?)(?: at {_TIME})?)?": _run,
    rf"ends(?: at {_TIME})?": _ends,
    "continues": _continues,
    r"fails with (\w+)": _fails,
    "misses nothing": _misses_nothing,
    rf"(\S+) at {_TIME} is (\S+)(?: \+- (\S+))?": _at,
    rf"(\S+) is in (\S+) \.\. (\S+) from {_TIME} to {_TIME}": _within,
    r"(\S+) comes at (.+)": _comes,
    rf"(\S+) comes every {_TIME} from {_TIME} to {_TIME}": _comes_every,
    r"(\S+) passes (.+)": _passes,
    r"(\S+) is released as (\S+)": _released,
}
