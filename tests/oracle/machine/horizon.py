"""How far the clock counts: the instants and ages from which on a program no longer distinguishes times.

A state that is compared with others contains the present instant up to `instant`, and of every time that was read from
the clock its instant up to there and its age up to `age`. If a program computes with times in another way, both are
beyond every run, and the state contains the clock as it is: then a program that continues has infinitely many states.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from tests.oracle.programs.tree import (
    TIME,
    After,
    Assign,
    Bin,
    Comp,
    Expr,
    Guarded,
    If,
    If3,
    Index,
    Lit,
    Make,
    Mu,
    Now,
    Program,
    Read,
    Ref,
    Un,
    Value,
    Wait,
    While,
    Write,
    walk,
)  # fmt: skip

BEYOND = 2**70
"""Later than any instant of a run."""

FAR = 2**60
"""A number below which sums with instants of a run do not overflow."""

COMPARED = ("==", "!=", "<", "<=", ">", ">=")


class _UnboundedError(Exception):
    """A computation for which no instant and no age is late enough."""


@dataclass(frozen=True)
class Horizon:
    instant: int
    age: int
    kept: frozenset[str]  # the variables and channels with times that were read from the clock

    @property
    def bounded(self) -> bool:
        return self.instant < BEYOND

    def seen(self, name: str, value: Value | None, now: int) -> Value | None:
        """What the state contains of a value of a variable or a channel."""
        if name not in self.kept or not isinstance(value, int):
            return value
        return min(value, self.instant), min(now - value, self.age)


def horizon(program: Program) -> Horizon:
    kept = _kept(program)
    needs = _Needs(kept)
    try:
        for variable in program.variables:
            if variable.name in kept and abs(_whole(variable.initial)) >= FAR:
                raise _UnboundedError
        for law in program.laws:
            if kept & {name for _, _, name in law.inputs}:
                raise _UnboundedError
        for node in walk(program.body):
            needs.composition(node)
    except _UnboundedError:
        return Horizon(BEYOND, BEYOND, frozenset())
    return Horizon(needs.instant, needs.age, kept)


def _whole(value: Value) -> int:
    assert isinstance(value, int)
    return value


def _kept(program: Program) -> frozenset[str]:
    flows = [flow for node in walk(program.body) for flow in _flows(node)]
    found: set[str] = set()
    more = {"now"}
    while more:
        more = {name for name, value in flows if value.type == TIME and mentions(value, found)} - found
        found |= more
    return frozenset(found)


def _flows(node: Comp) -> Iterator[tuple[str, Expr]]:
    """Which expressions are stored where."""
    match node.event if isinstance(node, Guarded) else node:
        case Assign(target, value):
            yield target.name, value
        case Write(channel, value):
            yield channel, value
        case Read(channel, target):
            yield target.name, Ref(channel, target.type)


def mentions(expr: Expr, names: set[str] | frozenset[str]) -> bool:
    """Whether an expression uses the present instant, or one of these variables."""
    match expr:
        case Now():
            return True
        case Ref(name):
            return name in names
        case Lit():
            return False
        case Index(of, at):
            return mentions(of, names) or mentions(at, names)
        case Bin(_, left, right):
            return mentions(left, names) or mentions(right, names)
        case If3(condition, yes, no):
            return any(mentions(part, names) for part in (condition, yes, no))
        case Make(pieces):
            return any(mentions(part, names) for part in pieces)
        case _:
            pieces = getattr(expr, "arguments", None) or (expr.of,)
            return any(mentions(part, names) for part in pieces)


class _Needs:
    """Determines from which instant and from which age on all are equivalent."""

    def __init__(self, kept: frozenset[str]) -> None:
        self.kept = kept
        self.instant = 0
        self.age = 0

    def composition(self, node: Comp) -> None:
        match node:
            case Mu(_, until) if until is not None:
                self.computed(until)
            case While(condition) | If(condition):
                self.computed(condition)
            case Guarded(event, _, when):
                if when is not None:
                    self.computed(when)
                if isinstance(event, Write):
                    self.stored(event.value)
                if isinstance(event, After):
                    self.waited(event.time, event.at)
            case Assign(_, value) | Write(_, value):
                self.stored(value)
            case Wait(time, until):
                self.waited(time, until)

    def computed(self, expr: Expr) -> None:
        """A value in which times matter only through comparisons."""
        if not mentions(expr, self.kept):
            return
        match expr:
            case Bin(op, left, right) if op in COMPARED and left.type == TIME:
                self._compared(left, right)
            case Bin(op, left, right) if op in (*COMPARED, *"+-*/%", "and", "or") and left.type != TIME:
                self.computed(left)
                self.computed(right)
            case Un("not", of):
                self.computed(of)
            case If3(condition, yes, no):
                for part in (condition, yes, no):
                    self.computed(part)
            case _:
                raise _UnboundedError

    def stored(self, expr: Expr) -> None:
        """A value that may be a time itself: the present instant, a future one, or one that was kept."""
        if isinstance(expr, If3) and expr.type == TIME:
            self.computed(expr.condition)
            self.stored(expr.yes)
            self.stored(expr.no)
        elif expr.type != TIME or not mentions(expr, self.kept):
            self.computed(expr)
        elif not (isinstance(expr, Ref) or (self._linear(expr)[0] == {"now": 1} and self._linear(expr)[1] >= 0)):
            raise _UnboundedError

    def waited(self, time: int | Expr, until: bool) -> None:
        if isinstance(time, int):
            self.instant = max(self.instant, time if until else 0)
        elif isinstance(time, If3):
            self.computed(time.condition)
            self.waited(time.yes, until)
            self.waited(time.no, until)
        elif mentions(time, self.kept) or until:
            times, constant = self._linear(time)
            if until:
                times = _without_zeros({**times, "now": times.get("now", 0) - 1})
            self._alike(times, constant)
            if len(times) == 2 and times["now"] > 0:  # the wait grows with the age
                raise _UnboundedError

    def _compared(self, left: Expr, right: Expr) -> None:
        one, other = self._linear(left), self._linear(right)
        times = {name: one[0].get(name, 0) - other[0].get(name, 0) for name in one[0] | other[0]}
        self._alike(_without_zeros(times), one[1] - other[1])

    def _alike(self, times: dict[str, int], constant: int) -> None:
        """From which instant or age on the sign of a sum of times and a constant no longer changes."""
        match sorted(times.values()):
            case []:
                pass
            case [1] | [-1]:
                self.instant = max(self.instant, abs(constant) + 1)
            case [-1, 1] if "now" in times:
                self.age = max(self.age, abs(constant) + 1)
            case _:
                raise _UnboundedError

    def _linear(self, expr: Expr) -> tuple[dict[str, int], int]:
        """How often each time is added, and the constant."""
        match expr:
            case Now():
                return {"now": 1}, 0
            case Ref(name) if name in self.kept:
                return {name: 1}, 0
            case Lit(value) if abs(_whole(value)) < FAR:
                return {}, _whole(value)
            case Bin("+" | "-" as op, left, right):
                sign = 1 if op == "+" else -1
                one, other = self._linear(left), self._linear(right)
                names = one[0] | other[0]
                times = {name: one[0].get(name, 0) + sign * other[0].get(name, 0) for name in names}
                return _without_zeros(times), one[1] + sign * other[1]
            case _:
                raise _UnboundedError


def _without_zeros(times: dict[str, int]) -> dict[str, int]:
    return {name: count for name, count in times.items() if count}
