"""Sequential processes with a few variables, as text and as the steps that they can take, for the oracle of
refinements, which shares nothing with the transition systems.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from random import Random
from typing import Literal, TypeAlias

Number: TypeAlias = int | bool | tuple[int, int]
Environment: TypeAlias = tuple[tuple[str, Number], ...]
Label: TypeAlias = tuple[str, Number]
"""A port and the value that passes it."""

INPUTS = {"a": "bool", "x": "int"}
OUTPUTS = {"c": "bool", "y": "int"}
VARIABLES = {
    "n": "int = 0",
    "b": "bool = false",
    "m": "int = 1",
    "k": "int[2] = [2, 3]",
    "p": "Two = Two(f = 4, g = 5)",
}
FIRST: Environment = (("n", 0), ("b", False), ("m", 1), ("k", (2, 3)), ("p", (4, 5)))
HEAD = """struct Two {
  f : int
  g : int
}

submodel Law {
  in  u : int
  out v : int

  v = 2 * u + 1
}
"""
"""What the processes need."""


@dataclass(frozen=True)
class Condition:
    """``n`` compared with a number, or ``b``."""

    operator: Literal["==", "!=", "<", ">=", "b", "not b"]
    number: int = 0

    def __str__(self) -> str:
        return self.operator if "b" in self.operator else f"n {self.operator} {self.number}"

    def holds(self, environment: Environment) -> bool:
        """Whether the condition holds."""
        values = dict(environment)
        n = values["n"]
        match self.operator:
            case "b":
                return bool(values["b"])
            case "not b":
                return not values["b"]
            case "==":
                return n == self.number
            case "!=":
                return n != self.number
            case "<":
                return n < self.number
            case ">=":
                return n >= self.number


@dataclass(frozen=True)
class Do:
    """One step: ``a ? b``, ``x ? n``, ``c ! e``, ``y ! e``, an assignment, a law from ``n`` to ``m``, a delay, a
    time-out (as a guard), or nothing.
    """

    kind: Literal["read", "write", "assign", "law", "wait", "after", "skip"]
    name: str = ""
    value: str = ""

    def __str__(self) -> str:
        match self.kind:
            case "read":
                return f"{self.name} ? {self.value}"
            case "write":
                return f"{self.name} ! {self.value}"
            case "assign":
                return f"{self.name} := {self.value}"
            case "law":
                return "law"
            case "wait":
                return "wait 1 ms"
            case "after":
                return f"after {self.value} ms"
            case "skip":
                return "skip"


@dataclass(frozen=True)
class Sequence:
    """One after the other."""

    steps: tuple[Statement, ...]

    def __str__(self) -> str:
        return f"({' ; '.join(map(str, self.steps))})"


@dataclass(frozen=True)
class If:
    """A choice by a test."""

    test: Condition
    then: Statement
    otherwise: Statement

    def __str__(self) -> str:
        return f"(if {self.test} then {self.then} else {self.otherwise})"


@dataclass(frozen=True)
class Loop:
    """``mu body``, forever or until a test holds."""

    body: Statement
    until: Condition | None

    def __str__(self) -> str:
        return f"(mu {self.body})" if self.until is None else f"(mu {self.body} until {self.until})"


@dataclass(frozen=True)
class Guarded:
    """A branch of an alternative."""

    when: Condition | None
    guard: Do
    body: Statement

    def __str__(self) -> str:
        condition = "" if self.when is None else f"when {self.when} & "
        return f"{condition}{self.guard} -> {self.body}"


@dataclass(frozen=True)
class Alternative:
    """Alternatives: the first guard that becomes ready; if several are ready any of them, or with ``prioritized`` the
    first in the text.
    """

    branches: tuple[Guarded, ...]
    prioritized: bool = False

    def __str__(self) -> str:
        return f"({(' []> ' if self.prioritized else ' [] ').join(map(str, self.branches))})"

    def possible(self, environment: Environment) -> Iterator[Guarded]:
        """The branches that may be chosen: what comes from outside may come at any time, outputs and ``skip`` are
        always ready.
        """
        enabled = [branch for branch in self.branches if branch.when is None or branch.when.holds(environment)]
        at_once = [branch for branch in enabled if branch.guard.kind in ("write", "skip")]
        soonest = min((branch.guard.value for branch in enabled if branch.guard.kind == "after"), default="")
        timed_out = False
        for branch in enabled:
            if branch.guard.kind == "after":
                if at_once or branch.guard.value > soonest or (self.prioritized and timed_out):
                    continue
                timed_out = True
            yield branch
            if self.prioritized and branch in at_once:
                return


Statement: TypeAlias = Do | Sequence | If | Loop | Alternative


@dataclass(frozen=True)
class _Again:
    """The end of an iteration of a loop."""

    loop: Loop


Todo: TypeAlias = tuple[Statement | _Again, ...]
State: TypeAlias = tuple[Todo, Environment]
"""What is still to be done, the next step first, and the variables."""


def process(name: str, body: Statement, without: str = "", *, sampled: bool = False) -> str:
    """The text of a process, ``without`` one of the ports; with ``x`` sampled or not."""
    period = {"x": " @ 1 ms"} if sampled else {}
    ports = [f"in {port} : {type_}{period.get(port, '')}" for port, type_ in INPUTS.items() if port != without]
    ports += [f"out {port} : {type_}" for port, type_ in OUTPUTS.items() if port != without]
    return (
        f"process {name} {{\n  "
        + "\n  ".join(ports)
        + "\n  communication {\n"
        + "".join(f"    var {variable} : {type_}\n" for variable, type_ in VARIABLES.items())
        + ("    law : Law\n    n -> law.u\n    law.v -> m\n" if re.search(r"\blaw\b", str(body)) else "")
        + "  }\n"
        + f"  composition {{ {body} }}\n}}\n"
    )


def steps(state: State, numbers: tuple[int, ...]) -> Iterator[tuple[Label | None, State]]:
    """The possible steps in a state, and the states after them; inputs have ``numbers``. None is a hidden step."""
    todo, environment = state
    if not todo:
        return
    first, rest = todo[0], todo[1:]
    match first:
        case Do():
            yield from _done(first, rest, environment, numbers)
        case Sequence():
            yield None, (first.steps + rest, environment)
        case If():
            chosen = first.then if first.test.holds(environment) else first.otherwise
            yield None, ((chosen, *rest), environment)
        case Loop():
            again = _Again(first)
            yield None, ((first.body, again, *rest), environment)
        case _Again():
            loop = first.loop
            ends = loop.until is not None and loop.until.holds(environment)
            yield None, (rest, environment) if ends else ((loop, *rest), environment)
        case Alternative():
            for branch in first.possible(environment):
                yield from _done(branch.guard, (branch.body, *rest), environment, numbers)


def _done(
    step: Do, rest: Todo, environment: Environment, numbers: tuple[int, ...]
) -> Iterator[tuple[Label | None, State]]:
    match step.kind:
        case "read":
            values: tuple[Number, ...] = (False, True) if INPUTS[step.name] == "bool" else numbers
            for value in values:
                yield (step.name, value), (rest, _with(environment, step.value, value))
        case "write":
            yield (step.name, _value(step.value, environment)), (rest, environment)
        case "assign":
            yield None, (rest, _with(environment, step.name, _value(step.value, environment)))
        case "law":
            yield None, (rest, _with(environment, "m", _value("2 * n + 1", environment)))
        case "wait" | "after" | "skip":
            yield None, (rest, environment)


def _with(environment: Environment, name: str, value: Number) -> Environment:
    variable, _, index = name.partition("[")
    if index:
        old = dict(environment)[variable]
        assert isinstance(old, tuple)
        at, new = int(index[0]), int(value)  # type: ignore[arg-type]
        value = (new, old[1]) if at == 0 else (old[0], new)
    return tuple((known, value if known == variable else old) for known, old in environment)


def _value(text: str, environment: Environment) -> Number:
    values = dict(environment)
    match text.replace("Two(f = n, g = m)", "two").split():
        case ["two"]:
            return values["n"], values["m"]  # type: ignore[return-value]
        case ["2", "*", "n", "+", "1"]:
            return 2 * int(values["n"]) + 1  # type: ignore[arg-type]
        case ["k[0]"] | ["k[1]"]:
            return values["k"][int(text[2])]  # type: ignore[index]
        case ["p.f"]:
            return values["p"][0]  # type: ignore[index]
        case ["p.g"]:
            return values["p"][1]  # type: ignore[index]
        case ["true"] | ["false"]:
            return text == "true"
        case ["not", "b"]:
            return not values["b"]
        case [name] if name in values:
            return values[name]
        case ["n", "+", number]:
            return int(values["n"]) + int(number)  # type: ignore[arg-type]
        case ["n", "-", number]:
            return int(values["n"]) - int(number)  # type: ignore[arg-type]
        case _:
            return int(text)


def erased(body: Statement, port: str) -> Statement:
    """The same process, with nothing in place of the communications at a port."""
    match body:
        case Do():
            return Do("skip") if body.name == port else body
        case Sequence(steps=parts):
            return Sequence(tuple(erased(part, port) for part in parts))
        case If():
            return If(body.test, erased(body.then, port), erased(body.otherwise, port))
        case Loop():
            return Loop(erased(body.body, port), body.until)
        case Alternative(branches=branches):
            return Alternative(
                tuple(
                    Guarded(branch.when, Do("skip") if branch.guard.name == port else branch.guard, inside)
                    for branch in branches
                    for inside in (erased(branch.body, port),)
                ),
                body.prioritized,
            )


class Drawing:
    """Draws processes with certain ports; every loop waits somewhere. ``numbers`` are those of conditions and
    assignments.
    """

    def __init__(self, random: Random, numbers: tuple[int, ...], ports: tuple[str, ...] = (*INPUTS, *OUTPUTS)) -> None:
        self._random = random
        self._numbers = numbers
        self._ports = ports

    def body(self) -> Statement:
        """The composition of a process."""
        return Loop(self._waiting(self.statement(3)), None if self._random.random() < 0.6 else self.test())

    def changed(self, body: Statement) -> Statement:
        """The same statement, with at most one change."""
        if self._random.random() < 0.15:
            return self.statement(2)
        match body:
            case Sequence(steps=parts):
                at = self._random.randrange(len(parts))
                return Sequence((*parts[:at], self.changed(parts[at]), *parts[at + 1 :]))
            case If():
                if self._random.random() < 0.5:
                    return If(body.test, self.changed(body.then), body.otherwise)
                return If(self.test(), body.then, body.otherwise)
            case Loop():
                return Loop(self.changed(body.body), body.until)
            case Alternative(branches=branches):
                at = self._random.randrange(len(branches))
                used = {branch.guard.name for branch in branches}
                free = [port for port in self._ports if port not in used]
                if free and self._random.random() < 0.3:
                    return Alternative((*branches, self._branch(self._random.choice(free), 1)), body.prioritized)
                if self._random.random() < 0.2:
                    return Alternative(branches, not body.prioritized)
                branch = branches[at]
                new = Guarded(branch.when, branch.guard, self.changed(branch.body))
                return Alternative((*branches[:at], new, *branches[at + 1 :]), body.prioritized)
            case Do():
                return body if self._random.random() < 0.5 else self._do()

    def statement(self, depth: int) -> Statement:
        """Any statement, at most ``depth`` levels deep."""
        if depth == 0:
            return self._do()
        match self._random.choice(("sequence", "sequence", "if", "alternative", "alternative", "do", "loop")):
            case "sequence":
                return Sequence(tuple(self.statement(depth - 1) for _ in range(self._random.randint(2, 3))))
            case "if":
                return If(self.test(), self.statement(depth - 1), self.statement(depth - 1))
            case "alternative":
                ports = self._random.sample(self._ports, self._random.randint(2, 3))
                branches = [self._branch(port, depth - 1) for port in ports]
                return Alternative(tuple(branches), self._random.random() < 0.3)
            case "loop":
                return Loop(self._waiting(self.statement(depth - 1)), self.test())
        return self._do()

    def test(self) -> Condition:
        """A condition."""
        operator = self._random.choice(("==", "==", "!=", "<", ">=", "b", "not b"))
        return Condition(operator, self._random.choice(self._numbers))  # type: ignore[arg-type]

    def refined(self, body: Statement) -> Statement:
        """A statement that does no more than ``body``: some of its free choices are made, some of its values written in
        another way.
        """
        match body:
            case Sequence(steps=parts):
                return Sequence(tuple(map(self.refined, parts)))
            case If():
                return If(body.test, self.refined(body.then), self.refined(body.otherwise))
            case Loop():
                return Loop(self.refined(body.body), body.until)
            case Alternative(branches=branches):
                kept = [Guarded(branch.when, branch.guard, self.refined(branch.body)) for branch in branches]
                return Alternative(tuple(kept), body.prioritized or self._random.random() < 0.3)
            case Do(kind="write", name="y", value=value) if value.lstrip("-").isdigit() and self._random.random() < 0.5:
                return Sequence((Do("assign", "k[0]", value), Do("write", "y", "k[0]")))
        return Sequence((Do("skip"), body)) if self._random.random() < 0.2 else body

    def _waiting(self, rest: Statement) -> Statement:
        first = self._random.choice((Do("wait"), *(self._at(port) for port in INPUTS if port in self._ports)))
        return Sequence((first, rest))

    def _branch(self, port: str, depth: int) -> Guarded:
        guard = Do("skip") if self._random.random() < 0.15 else self._at(port)
        if self._random.random() < 0.15:
            guard = Do("after", "", self._random.choice("12"))
        return Guarded(self.test() if self._random.random() < 0.3 else None, guard, self.statement(depth))

    def _do(self) -> Do:
        if self._random.random() < 0.3:
            number = self._random.choice(self._numbers)
            value = self._random.choice(("n + 1", "n + 1", "n - 1", str(number)))
            values = {"n": (value, "m", "k[1]"), "m": ("n", "k[0]", "p.g", str(number)), "k[0]": ("n", "m")}
            values |= {"k[1]": ("m",), "p": ("Two(f = n, g = m)",), "b": ("not b",)}
            name = self._random.choice(("n", "n", "m", "k[0]", "k[1]", "p", "b"))
            assigned = Do("assign", name, self._random.choice(values[name]))
            return self._random.choice((assigned, assigned, Do("law"), Do("wait"), Do("skip")))
        return self._at(self._random.choice(self._ports))

    def _at(self, port: str) -> Do:
        """A communication at a port."""
        match port:
            case "a":
                return Do("read", "a", "b")
            case "x":
                return Do("read", "x", "n")
            case "c":
                return Do("write", "c", self._random.choice(("true", "false", "b", "not b")))
        return Do(
            "write",
            "y",
            self._random.choice(("n", "n", "m", "k[0]", "p.f", "n + 1", str(self._random.choice(self._numbers)))),
        )
