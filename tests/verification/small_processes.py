"""Sequential processes with a few variables, as text and as what they can do: the oracle of refinements, which shares nothing with the transition systems."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from random import Random
from typing import Literal, TypeAlias

Number: TypeAlias = int | bool
Environment: TypeAlias = tuple[tuple[str, Number], ...]
Label: TypeAlias = tuple[str, Number]
"""A port and the value that passes it."""

INPUTS = {"a": "bool", "x": "int"}
OUTPUTS = {"c": "bool", "y": "int"}
VARIABLES = {"n": "int", "b": "bool"}
FIRST: Environment = (("n", 0), ("b", False))


@dataclass(frozen=True)
class Condition:
    """``n`` compared with a number, or ``b``."""

    operator: Literal["==", "!=", "<", ">=", "b", "not b"]
    number: int = 0

    def __str__(self) -> str:
        return self.operator if "b" in self.operator else f"n {self.operator} {self.number}"

    def holds(self, environment: Environment) -> bool:
        """Whether it does."""
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
    """One step: ``a ? b``, ``x ? n``, ``c ! e``, ``y ! e``, an assignment, a delay, or nothing."""

    kind: Literal["read", "write", "assign", "wait", "skip"]
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
            case "wait":
                return "wait 1 ms"
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
    """``mu body``, for ever or until a test holds."""

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
    """The first of its guards that comes."""

    branches: tuple[Guarded, ...]

    def __str__(self) -> str:
        return f"({' [] '.join(map(str, self.branches))})"


Statement: TypeAlias = Do | Sequence | If | Loop | Alternative


@dataclass(frozen=True)
class _Again:
    """The end of a round of a loop."""

    loop: Loop


Todo: TypeAlias = tuple[Statement | _Again, ...]
State: TypeAlias = tuple[Todo, Environment]
"""What is still to be done, the next first, and the variables."""


def process(name: str, body: Statement, without: str = "") -> str:
    """The text of a process, ``without`` one of the ports."""
    ports = [f"in {port} : {type_}" for port, type_ in INPUTS.items() if port != without]
    ports += [f"out {port} : {type_}" for port, type_ in OUTPUTS.items() if port != without]
    return (
        f"process {name} {{\n  "
        + "\n  ".join(ports)
        + "\n  communication {\n    var n : int = 0\n    var b : bool = false\n  }\n"
        + f"  composition {{ {body} }}\n}}\n"
    )


def steps(state: State, numbers: tuple[int, ...]) -> Iterator[tuple[Label | None, State]]:
    """What can be done in a state, and the states after it; inputs have ``numbers``. None is what nobody sees."""
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
            for branch in first.branches:
                if branch.when is None or branch.when.holds(environment):
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
        case "wait" | "skip":
            yield None, (rest, environment)


def _with(environment: Environment, name: str, value: Number) -> Environment:
    return tuple((known, value if known == name else old) for known, old in environment)


def _value(text: str, environment: Environment) -> Number:
    values = dict(environment)
    match text.split():
        case ["true"] | ["false"]:
            return text == "true"
        case ["not", "b"]:
            return not values["b"]
        case [name] if name in values:
            return values[name]
        case ["n", "+", number]:
            return values["n"] + int(number)
        case ["n", "-", number]:
            return values["n"] - int(number)
        case _:
            return int(text)


def erased(body: Statement, port: str) -> Statement:
    """The same, with nothing instead of the communications at a port."""
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
                )
            )


class Drawing:
    """Draws processes with certain ports; every loop waits somewhere. ``numbers`` are those of tests and assignments."""

    def __init__(self, random: Random, numbers: tuple[int, ...], ports: tuple[str, ...] = (*INPUTS, *OUTPUTS)) -> None:
        self._random = random
        self._numbers = numbers
        self._ports = ports

    def body(self) -> Statement:
        """The composition of a process."""
        return Loop(self._waiting(self.statement(3)), None if self._random.random() < 0.6 else self.test())

    def changed(self, body: Statement) -> Statement:
        """The same, but for one place at most."""
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
                    return Alternative((*branches, self._branch(self._random.choice(free), 1)))
                branch = branches[at]
                new = Guarded(branch.when, branch.guard, self.changed(branch.body))
                return Alternative((*branches[:at], new, *branches[at + 1 :]))
            case Do():
                return body if self._random.random() < 0.5 else self._do()

    def statement(self, depth: int) -> Statement:
        """Anything, with so many levels at most."""
        if depth == 0:
            return self._do()
        match self._random.choice(("sequence", "sequence", "if", "alternative", "alternative", "do", "loop")):
            case "sequence":
                return Sequence(tuple(self.statement(depth - 1) for _ in range(self._random.randint(2, 3))))
            case "if":
                return If(self.test(), self.statement(depth - 1), self.statement(depth - 1))
            case "alternative":
                ports = self._random.sample(self._ports, self._random.randint(2, 3))
                return Alternative(tuple(self._branch(port, depth - 1) for port in ports))
            case "loop":
                return Loop(self._waiting(self.statement(depth - 1)), self.test())
        return self._do()

    def test(self) -> Condition:
        """A condition."""
        operator = self._random.choice(("==", "==", "!=", "<", ">=", "b", "not b"))
        return Condition(operator, self._random.choice(self._numbers))  # type: ignore[arg-type]

    def _waiting(self, rest: Statement) -> Statement:
        first = self._random.choice((Do("wait"), *(self._at(port) for port in INPUTS if port in self._ports)))
        return Sequence((first, rest))

    def _branch(self, port: str, depth: int) -> Guarded:
        guard = Do("skip") if self._random.random() < 0.1 else self._at(port)
        return Guarded(self.test() if self._random.random() < 0.3 else None, guard, self.statement(depth))

    def _do(self) -> Do:
        if self._random.random() < 0.3:
            number = self._random.choice(self._numbers)
            value = self._random.choice(("n + 1", "n + 1", "n - 1", str(number)))
            return self._random.choice((Do("assign", "n", value), Do("assign", "b", "not b"), Do("wait"), Do("skip")))
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
        return Do("write", "y", self._random.choice(("n", "0", str(self._random.choice(self._numbers)))))
