"""The composition of the one process that carries out a schedule."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from cspdiag.base.record import replaced
from cspdiag.model.types import BOOL, INT, TIME, Type
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.expressions import BinaryOperation, Expression, LiteralValue, UnaryOperation, VariableValue
from cspdiag.network.ir.network import LocalChannel
from cspdiag.network.lower.distinct_names import DistinctNames
from cspdiag.optimize.changes import in_sequence
from cspdiag.optimize.fuse.code import Failure
from cspdiag.optimize.fuse.follow import Ends, Repeats
from cspdiag.optimize.fuse.record import Decision, Step
from cspdiag.optimize.fuse.rolling import rolled
from cspdiag.optimize.fuse.schedule import Path


class PathWriter:
    """Writes a path as a composition, ``body``, and the ``variables`` that it needs in addition.

    ``place`` gives the source place of generated actions. ``followed`` gives the positions of samples before which the
    process begins to follow inputs, with their ends, beginning with that of the sample. ``closing``: the ends of
    processes that end are closed.
    """

    def __init__(
        self,
        path: Path,
        place: ir.Action,
        taken: Iterable[str],
        followed: Mapping[int, tuple[ir.End, ...]],
        *,
        closing: bool,
    ) -> None:
        self._place = place
        self._names = DistinctNames((*taken, *path.made))
        self._followed = followed
        self._closing = closing
        self._loop = path.outcome.position if isinstance(path.outcome, Repeats) else None
        self.alternatives: list[str] = []
        """The names of the alternatives that it makes."""
        self._counters: dict[str, LiteralValue] = {}
        self._ended: str | None = None
        self.body = self._from(path, 0, 0)
        made: list[tuple[str, Type, Expression | None]] = [(name, kind, None) for name, kind in path.made.items()]
        made += [(name, initial.type, initial) for name, initial in self._counters.items()]
        self.variables = tuple(
            LocalChannel(name=name, span=place.span, type=kind, kind="var", initial=initial)
            for name, kind, initial in made
        )

    @property
    def counters(self) -> frozenset[str]:
        """The variables that count iterations, or mark the end of the program."""
        return frozenset(self._counters)

    def _counter(self, name: str, initial: LiteralValue) -> str:
        unique = self._names.fresh(name, lambda number: f"{name}_{number}")
        self._counters[unique] = initial
        return unique

    def _turn(self) -> str:
        return self._counter("turn", LiteralValue(type=INT, value=0))

    def _from(self, path: Path, first: int, now: int) -> ir.Action:
        """The occurrences from the position ``first`` and the instant ``now`` on."""
        match path.outcome:
            case Ends(failure=failure):
                end: list[ir.Action] = []
                if failure is not None:
                    end.append(_raised(failure))
                return self._straight(path, first, len(path.occurrences), now, path.now, end)
            case Repeats():
                return self._looping(path, first, now, path.outcome)

    def _looping(self, path: Path, first: int, now: int, loops: Repeats) -> ir.Action:
        start, end = loops.position, len(path.occurrences)
        leaving = [
            p for p in range(start, end) if isinstance(path.occurrences[p], Decision) and _ends_well(path.exits[p])
        ]
        until = None if self._waits_itself(path, start, loops.since) else loops.since
        again = None if until is None else path.now
        if len(leaving) == 1:
            return self._leaving(path, first, now, loops, leaving[0])
        if leaving:
            self._ended = self._ended or self._counter("ended", LiteralValue(type=BOOL, value=False))
        body = self._straight(path, start, end, loops.since, again, [], in_loop=True)
        ended: Expression | None = None
        if leaving:
            assert self._ended is not None
            ended = VariableValue(type=BOOL, channel=self._ended)
        loop = ir.Repeat(span=self._place.span, body=body, until=ended)
        return self._straight(path, first, start, now, until, [*self._samples_before(path, start), loop])

    def _leaving(self, path: Path, first: int, now: int, loops: Repeats, leave: int) -> ir.Action:
        """A loop with one exit, which becomes its condition."""
        start, end = loops.position, len(path.occurrences)
        turn = path.occurrences[leave]
        assert isinstance(turn, Decision)
        waits_itself = self._waits_itself(path, start, loops.since)
        first_part = self._straight(path, start, leave, loops.since, turn.time, [])
        second_part = self._straight(path, leave + 1, end, turn.time, None if waits_itself else path.now, [])
        condition = turn.condition if turn.holds else opposite(turn.condition)
        body = in_sequence([second_part, first_part], self._place)
        after = self._from(path.exits[leave], leave + 1, turn.time)
        until = None if waits_itself else loops.since
        before = self._samples_before(path, start)
        span = self._place.span
        if isinstance(second_part, ir.SkipStep):
            again: ir.Action = ir.Repeat(span=span, body=first_part, until=opposite(condition))
            return self._straight(path, first, start, now, until, [*before, again, after])
        again = ir.WhileLoop(span=span, condition=condition, body=body)
        return self._straight(path, first, start, now, until, [*before, first_part, again, after])

    def _samples_before(self, path: Path, loop: int) -> list[ir.Action]:
        """If a loop begins with a first sample, the wait for it before the loop."""
        return [self._begin(loop)] if loop in self._followed else []

    def _waits_itself(self, path: Path, position: int, now: int) -> bool:
        """Whether the occurrence at a position waits for a sample that arrives at this instant."""
        first = path.occurrences[position] if position < len(path.occurrences) else None
        return isinstance(first, Step) and first.fresh and first.time == now

    def _straight(
        self,
        path: Path,
        first: int,
        last: int,
        now: int,
        until: int | None,
        end: list[ir.Action],
        in_loop: bool = False,
    ) -> ir.Action:
        """The occurrences between two positions, a wait until an instant, and what follows."""
        steps: list[ir.Action] = []
        for position in range(first, last):
            occurrence = path.occurrences[position]
            if not self._closing and isinstance(occurrence, Step) and isinstance(occurrence.action, ir.ProcessScope):
                continue
            if occurrence.time > now and not (isinstance(occurrence, Step) and occurrence.fresh):
                steps.append(self._wait(occurrence.time - now))
            now = occurrence.time
            if isinstance(occurrence, Step):
                if position in self._followed and position != self._loop:
                    steps.append(self._begin(position))
                steps.append(occurrence.action)
                continue
            other = path.exits[position]
            instead = self._from(other, position + 1, now)
            condition = opposite(occurrence.condition) if occurrence.holds else occurrence.condition
            span = occurrence.condition.span or self._place.span
            if not _ends_well(other):
                otherwise: ir.Action = ir.SkipStep(span=span)
                steps.append(ir.IfElse(span=span, condition=condition, then=instead, otherwise=otherwise))
                continue
            if in_loop:
                assert self._ended is not None
                value = LiteralValue(type=BOOL, value=True)
                ended = ir.AssignValue(span=span, target=ir.Target(self._ended), value=value)
                instead = in_sequence([instead, ended], self._place)
            otherwise = self._straight(path, position + 1, last, now, until, end, in_loop)
            if isinstance(instead, ir.SkipStep):
                condition, instead, otherwise = opposite(condition), otherwise, instead
            steps.append(ir.IfElse(span=span, condition=condition, then=instead, otherwise=otherwise))
            return in_sequence(rolled(steps, self._turn), self._place)
        if until is not None and until > now:
            steps.append(self._wait(until - now))
        return in_sequence([*rolled(steps, self._turn), *end], self._place)

    def _begin(self, position: int) -> ir.Action:
        """Wait for a sample, and so begin to follow other inputs at the same time."""
        span = self._place.span
        skip = ir.SkipStep(span=span)
        branches = (
            ir.Branch(span=span, condition=None, event=ir.ReadyEvent(span=span, source=end), body=skip)
            for end in self._followed[position]
        )
        name = "samples" if not self.alternatives else f"samples_{len(self.alternatives) + 1}"
        self.alternatives.append(name)
        return ir.Choice(span=span, branches=tuple(branches), prioritized=True, name=name)

    def _wait(self, duration: int) -> ir.Action:
        return ir.WaitStep(span=self._place.span, duration=LiteralValue(type=TIME, value=duration))


def _raised(failure: Failure) -> ir.Action:
    """The exception as raised by the process that raised it."""
    return failure.action if failure.process is None else replaced(failure.process, ends=(), body=failure.action)


def _ends_well(path: Path) -> bool:
    return isinstance(path.outcome, Ends) and path.outcome.failure is None


def opposite(condition: Expression) -> Expression:
    """A condition that holds if and only if this one does not."""
    match condition:
        case BinaryOperation(operator="=="):
            return replaced(condition, operator="!=")
        case BinaryOperation(operator="!="):
            return replaced(condition, operator="==")
        case UnaryOperation(operator="not"):
            return condition.operand
        case _:  # Any other condition.
            return UnaryOperation(type=BOOL, span=condition.span, operator="not", operand=condition)
