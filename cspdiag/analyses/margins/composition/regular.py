"""Which loops of a program do the same in each period: the turns that margins can follow."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import ClassVar

from cspdiag.analyses.margins.composition.turns import Composition, Loop, Statement, statements_of
from cspdiag.base import Span
from cspdiag.base.record import record, replaced
from cspdiag.network.ir.network import CoreNetwork, Net


@record
class Turn:
    """One period of a loop; ``period`` in nanoseconds is 0 and ``reason`` says why if it is not known to be the same
    each time.

    ``main`` takes the samples of ``inputs``, which are nets, and begins with what waits for the next instant;
    ``leading`` are the statements before that in the text, which run at the end of the previous iteration.
    Before or after ``main`` the loop takes values from other loops, by the branches of its alternative.
    """

    uncompared: ClassVar[frozenset[str]] = frozenset()

    loop: Loop
    period: int
    reason: str
    span: Span
    inputs: tuple[str, ...] = ()
    main: tuple[Statement, ...] = ()
    before: tuple[tuple[Statement, ...], ...] = ()
    after: tuple[tuple[Statement, ...], ...] = ()
    leading: tuple[Statement, ...] = ()


class Turns:
    """The turns of all loops of a program, by position."""

    def __init__(self, network: CoreNetwork, composition: Composition) -> None:
        self.nets = {net.path: net for net in network.nets}
        self.read_by: dict[str, list[str]] = {}
        """The nets that each process reads, by path."""
        self.written_by: dict[str, list[str]] = {}
        for net in network.nets:
            for path, _ in net.readers:
                self.read_by.setdefault(path, []).append(net.path)
            for path, _ in net.writers:
                self.written_by.setdefault(path, []).append(net.path)
        self.composition = composition
        self.found = {position: self._turn(loop) for position, loop in composition.loops.items()}
        self._find_driven()

    def reads(self, statement: Statement) -> tuple[str, ...]:
        """The nets that a statement reads by communicating."""
        if statement.law is not None:
            return tuple(dict.fromkeys(self.read_by.get(statement.law, ())))
        return statement.sources if statement.value is None else ()

    def _turn(self, loop: Loop) -> Turn:
        inside = list(statements_of(self.composition.statements, loop.position))
        for statement in inside:
            if statement.law is None and statement.target is None:
                return Turn(loop, 0, statement.reason, statement.span)
        sampled = [(s, net) for s in inside for net in map(self.nets.get, self.reads(s)) if _is_sampled(net)]
        branches = {statement.branch for statement, _ in sampled}
        chosen = min(branches, default=0)
        turn = Turn(
            loop, 0, "", loop.span, tuple(dict.fromkeys(net.path for _, net in sampled if net is not None)),
            _branch(inside, chosen),
            tuple(_branch(inside, k) for k in range(chosen)),
            tuple(_branch(inside, k) for k in range(chosen + 1, loop.branches)),
        )  # fmt: skip
        if not sampled:
            reason = "none of the branches of its alternative takes a sample" if loop.branches > 1 else ""
            return replaced(turn, reason=reason)
        stopped = next((statement for statement, _ in sampled if statement.reason), None)
        if stopped is not None:
            return replaced(turn, reason=stopped.reason, span=stopped.span)
        periods = {net.sampling.period for _, net in sampled if net is not None and net.sampling is not None}
        problem = self._problem(turn, [statement for statement, _ in sampled])
        if len(branches) > 1:
            problem = "several branches of its alternative take samples", loop.span
        elif len(periods) > 1:
            problem = "it takes samples of several periods", loop.span
        if problem is not None:
            return replaced(turn, reason=problem[0], span=problem[1])
        first = turn.main.index(next(statement for statement, _ in sampled))
        return _rotated(replaced(turn, period=min(periods)), first)

    def _problem(self, turn: Turn, sampling: Sequence[Statement]) -> tuple[str, Span] | None:
        seen: set[str] = set()
        laws: set[str] = set()
        for statement in turn.main:
            if statement.law is not None and statement.law in laws:
                return "it runs a law twice", statement.span
            laws |= {statement.law} if statement.law is not None else set()
            for path in self.reads(statement):
                net = self.nets.get(path)
                if net is not None and net.external == "in" and net.sampling is None:
                    return f"it waits for the event `{path.partition('.')[2]}`", statement.span
                if _is_sampled(net) and path in seen:
                    return f"it takes two samples of `{path.partition('.')[2]}` in one iteration", statement.span
                seen |= {path} if _is_sampled(net) else set()
        if len({statement.process for statement in sampling}) > 1:
            return "it takes samples in several processes, each of which begins anew", sampling[-1].span
        return None

    def _find_driven(self) -> None:
        """Loops without samples have the period of those whose values they wait for."""
        for _ in self.found:
            for position, turn in self.found.items():
                if turn.period or turn.reason:
                    continue
                periods = {self._writer_period(path) for path in self._waits(turn)}
                if periods and 0 not in periods and len(periods) == 1:
                    problem = self._problem(turn, ())
                    if problem is None:
                        waits = [any(map(self._is_awaited, self.reads(part))) for part in turn.main]
                        first = waits.index(True)
                        self.found[position] = _rotated(replaced(turn, period=min(periods)), first)
                    else:
                        self.found[position] = replaced(turn, reason=problem[0], span=problem[1])
        for position, turn in self.found.items():
            if not turn.period and not turn.reason:
                self.found[position] = replaced(turn, reason="how often it repeats is not known")

    def _waits(self, turn: Turn) -> Iterator[str]:
        for statement in turn.main:
            yield from filter(self._is_awaited, self.reads(statement))

    def _is_awaited(self, path: str) -> bool:
        net = self.nets.get(path)
        return net is not None and net.kind != "var"

    def _writer_period(self, path: str) -> int:
        writers = [s for s in self.composition.statements if s.target == path or self.is_written_by(s, path)]
        periods = {self.found[s.turn].period if s.turn is not None and not s.reason else 0 for s in writers}
        return periods.pop() if len(periods) == 1 and len(writers) == 1 else 0

    def is_written_by(self, statement: Statement, path: str) -> bool:
        """Whether the law that a statement runs writes to a net."""
        return statement.law is not None and path in self.written_by.get(statement.law, ())


def _rotated(turn: Turn, first: int) -> Turn:
    """The turn as it runs: from the statement that waits for the next instant to the one before it."""
    leading = turn.main[:first]
    return replaced(turn, main=(*turn.main[first:], *leading), leading=leading)


def _branch(inside: Sequence[Statement], number: int) -> tuple[Statement, ...]:
    return tuple(statement for statement in inside if statement.branch == number)


def _is_sampled(net: Net | None) -> bool:
    return net is not None and net.external == "in" and net.sampling is not None
