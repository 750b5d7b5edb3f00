"""Finds the schedule of a program: what happens first, and what then happens again and again.

Where the program continues depending on a value, both paths are followed. At most one of them may continue forever; the
other is an exit, after which the program ends.
"""

from __future__ import annotations

from collections.abc import Sequence

from cspdiag.base.record import record, replaced
from cspdiag.model.types import Type
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.expressions import VariableValue
from cspdiag.network.ir.network import ExternalPort, ProcessClass
from cspdiag.network.ir.walk import parts
from cspdiag.optimize.fuse.code import Code, NotStaticError
from cspdiag.optimize.fuse.follow import Asks, Ends, Following, Loops
from cspdiag.optimize.fuse.record import Happening, Step, Turn

MOST_DECISIONS = 60


@record
class Path:
    """What happens from the start. ``exits`` has, by the position of a ``Turn``, what happens there instead, from the
    turn on.

    It ends (by an exception where ``outcome`` has one), or goes back to what happened first at the position that
    ``outcome`` has; it is then ``now``.
    """

    happenings: tuple[Happening, ...]
    outcome: Ends | Loops
    exits: dict[int, Path]
    made: dict[str, Type]
    now: int
    counting: frozenset[str]
    """The variables whose values were known."""
    followed: dict[ir.End, int]
    """Since when the ends of sampled inputs are read."""


def schedule_like(entry: ProcessClass, ports: Sequence[ExternalPort], path: Path, made: frozenset[str]) -> Path:
    """The schedule of a class that was written from a path, with ``made`` as variables that count. Raises
    NotStaticError.
    """
    return _explored(Code(entry, whole=_computations(path)), ports, path.counting | made, ())


def _computations(path: Path) -> set[ir.Action]:
    found = {step.action for step in path.happenings if isinstance(step, Step)}
    return found.union(*map(_computations, path.exits.values()))


def schedule(entry: ProcessClass, ports: Sequence[ExternalPort]) -> Path:
    """The schedule of a class without instances, run from time 0. Raises NotStaticError."""
    code = Code(entry)
    counting = counting_variables(entry)
    try:
        return _explored(code, ports, counting, ())
    except NotStaticError as reason:
        if not counting:
            raise
        try:
            return _explored(code, ports, frozenset(), ())
        except NotStaticError:
            raise reason from None


def _explored(code: Code, ports: Sequence[ExternalPort], counting: frozenset[str], decisions: tuple[bool, ...]) -> Path:
    following = Following(code, ports, counting, decisions)
    outcome = following.follow()
    record = following.record
    if not isinstance(outcome, Asks):
        return Path(
            tuple(record.happenings),
            outcome,
            {},
            record.made,
            following.now,
            counting,
            following.followed_since(),
        )
    if len(decisions) == MOST_DECISIONS:
        raise NotStaticError("what it does depends on values too often")
    position = len(record.happenings)
    holds = _explored(code, ports, counting, (*decisions, True))
    fails = _explored(code, ports, counting, (*decisions, False))
    main, other = (fails, holds) if isinstance(holds.outcome, Ends) else (holds, fails)
    if not isinstance(other.outcome, Ends):
        turn = main.happenings[position]
        assert isinstance(turn, Turn)
        raise NotStaticError("what it does next depends on a value", turn.condition.span)
    main.exits[position] = other
    return replaced(main, made={**main.made, **other.made})


def with_loop_early(path: Path) -> Path:
    """The same schedule, with the loop where it can begin first: what happens before it as it happens at its end is a
    part of it.
    """
    outcome = path.outcome
    if not isinstance(outcome, Loops):
        return path
    period = path.now - outcome.since
    start, end = outcome.position, len(path.happenings)
    while start > 0:
        last = path.happenings[end - 1]
        if isinstance(last, Turn) or replaced(path.happenings[start - 1], time=last.time) != last:
            break
        if last.time != path.happenings[start - 1].time + period:
            break
        start, end = start - 1, end - 1
    if start == outcome.position:
        return path
    since = path.happenings[start].time
    exits = {position: other for position, other in path.exits.items() if position < end}
    loops = Loops(start, since)
    return replaced(path, happenings=path.happenings[:end], outcome=loops, exits=exits, now=since + period)


def with_loop_begun(path: Path) -> Path:
    """The same schedule, with the first turn of its loop before the loop."""
    outcome = path.outcome
    assert isinstance(outcome, Loops)
    count = len(path.happenings)
    offset, later = count - outcome.position, path.now - outcome.since
    happenings = (*path.happenings, *_later(path.happenings[outcome.position :], later))
    exits = dict(path.exits)
    for position, other in path.exits.items():
        if position >= outcome.position:
            exits[position + offset] = _moved(other, position, happenings[: position + offset + 1], later)
    return replaced(path, happenings=happenings, outcome=Loops(count, path.now), exits=exits, now=path.now + later)


def _moved(path: Path, turn: int, before: tuple[Happening, ...], later: int) -> Path:
    """An exit that follows ``before``, the last of which is its turn."""
    offset = len(before) - turn - 1
    happenings = (*before, *_later(path.happenings[turn + 1 :], later))
    exits = {
        position + offset: _moved(other, position, happenings[: position + offset + 1], later)
        for position, other in path.exits.items()
        if position > turn
    }
    return replaced(path, happenings=happenings, exits=exits, now=path.now + later)


def _later(happenings: tuple[Happening, ...], time: int) -> tuple[Happening, ...]:
    return tuple(replaced(happening, time=happening.time + time) for happening in happenings)


def counting_variables(entry: ProcessClass) -> frozenset[str]:
    """Variables that decide where to go on and depend on nothing but such variables and constants, as those that count
    turns do.
    """
    made_from: dict[str, set[str]] = {}
    unknown: set[str] = set()
    asked: set[str] = set()
    for part in parts(entry.body):
        match part:
            case ir.AssignValue(target=target) if target.indexes:
                unknown.add(target.channel)
            case ir.AssignValue():
                made_from.setdefault(part.target.channel, set()).update(_variables(part.value))
            case ir.ReadValue(target=target) | ir.InputEvent(target=target):
                unknown.add(target.channel)
            case ir.ReadInputs():
                unknown.update(read.name for read in part.reads)
            case ir.OutputWrite(sink=ir.ChannelEnd(channel=name)):
                unknown.add(name)
            case ir.IfElse() | ir.WhileLoop():
                asked |= _variables(part.condition)
            case ir.Repeat():
                asked |= _variables(part.until)
            case ir.Choice():
                for branch in part.branches:
                    asked |= _variables(branch.condition)
            case _:  # Nothing else decides; what interrupts is not fused.
                pass
    pending = set(asked)
    while pending:
        needed = set().union(*(made_from.get(name, set()) for name in pending)) - asked
        asked |= needed
        pending = needed
    return frozenset(asked - unknown)


def _variables(item: object) -> set[str]:
    return {part.channel for part in parts(item) if isinstance(part, VariableValue)}
