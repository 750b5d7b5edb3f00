"""Finds the schedule of a program: the occurrences before a loop, and those that the loop repeats.

If control flow depends on a value, both paths are followed. At most one of them may continue forever; the other is an
exit, after which the program ends.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence
from collections.abc import Set as AbstractSet

from cspdiag.base.record import record, replaced
from cspdiag.model.types import Type
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.expressions import LiteralValue, VariableValue
from cspdiag.network.ir.network import ExternalPort, ProcessClass
from cspdiag.network.ir.walk import parts
from cspdiag.optimize.fuse.code import Code, NotStaticError
from cspdiag.optimize.fuse.follow import Ends, NeedsDecision, Repeats, SymbolicRun
from cspdiag.optimize.fuse.record import Decision, Occurrence, Step

LARGEST_NUMBER_OF_DECISIONS = 60


@record
class Path:
    """The occurrences from the start. ``exits`` gives, by the position of a ``Decision``, the path that is taken
    otherwise.

    At its end, at the instant ``now``, the program ends (by an exception if ``outcome`` has one), or continues at the
    position given by ``outcome``.
    """

    occurrences: tuple[Occurrence, ...]
    outcome: Ends | Repeats
    exits: dict[int, Path]
    made: dict[str, Type]
    now: int
    counting: frozenset[str]
    """The variables whose values were known."""
    followed: dict[ir.End, int]
    """The instants from which the ends of sampled inputs are read."""


def schedule_like(entry: ProcessClass, ports: Sequence[ExternalPort], path: Path, made: frozenset[str]) -> Path:
    """The schedule of a class that was written from a path, with ``made`` as variables that count. Raises
    NotStaticError.
    """
    return _explored(Code(entry, whole=_computations(path)), ports, path.counting | made, ())


def _computations(path: Path) -> set[ir.Action]:
    found = {step.action for step in path.occurrences if isinstance(step, Step)}
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
    following = SymbolicRun(code, ports, counting, decisions)
    outcome = following.follow()
    record = following.record
    if not isinstance(outcome, NeedsDecision):
        return Path(
            tuple(record.occurrences),
            outcome,
            {},
            record.made,
            following.now,
            counting,
            following.followed_since(),
        )
    if len(decisions) == LARGEST_NUMBER_OF_DECISIONS:
        raise NotStaticError("what it does depends on values too often")
    position = len(record.occurrences)
    holds = _explored(code, ports, counting, (*decisions, True))
    fails = _explored(code, ports, counting, (*decisions, False))
    main, other = (fails, holds) if isinstance(holds.outcome, Ends) else (holds, fails)
    if not isinstance(other.outcome, Ends):
        decision = main.occurrences[position]
        assert isinstance(decision, Decision)
        raise NotStaticError("what it does next depends on a value", decision.condition.span)
    main.exits[position] = other
    return replaced(main, made={**main.made, **other.made})


def without_unread_counts(path: Path) -> Path:
    """The same schedule without assignments of known values that nothing reads, such as those that count iterations:
    iterations that differ in nothing else are then equal.
    """
    return _without(path, path.counting - _read(path))


def _read(path: Path) -> set[str]:
    """The variables that occur anywhere except where they are assigned a known value."""
    steps = [occurrence for occurrence in path.occurrences if _counted(occurrence) is None]
    found = {part.channel for part in parts(steps) if isinstance(part, VariableValue | ir.Target | ir.ChannelEnd)}
    return found.union(*map(_read, path.exits.values()))


def _counted(occurrence: Occurrence) -> str | None:
    """The variable that an occurrence only assigns a known value; None if it does anything else."""
    match occurrence:
        case Step(action=ir.AssignValue(target=ir.Target(channel=name, indexes=()), value=LiteralValue())):
            return name
        case _:  # Any other occurrence.
            return None


def _without(path: Path, names: AbstractSet[str]) -> Path:
    kept = [position for position, each in enumerate(path.occurrences) if _counted(each) not in names]
    moved = {position: number for number, position in enumerate(kept)}
    outcome = path.outcome
    if isinstance(outcome, Repeats):
        outcome = Repeats(bisect_left(kept, outcome.position), outcome.since)
    return replaced(
        path,
        occurrences=tuple(path.occurrences[position] for position in kept),
        outcome=outcome,
        exits={moved[position]: _without(exit_, names) for position, exit_ in path.exits.items()},
    )


def with_earliest_loop(path: Path) -> Path:
    """The same schedule with the loop as early as possible: occurrences before it that equal those at its end become
    part of it.
    """
    outcome = path.outcome
    if not isinstance(outcome, Repeats):
        return path
    period = path.now - outcome.since
    start, end = outcome.position, len(path.occurrences)
    while start > 0:
        last = path.occurrences[end - 1]
        if isinstance(last, Decision) or replaced(path.occurrences[start - 1], time=last.time) != last:
            break
        if last.time != path.occurrences[start - 1].time + period:
            break
        start, end = start - 1, end - 1
    if start == outcome.position:
        return path
    since = path.occurrences[start].time
    exits = {position: other for position, other in path.exits.items() if position < end}
    repeats = Repeats(start, since)
    return replaced(path, occurrences=path.occurrences[:end], outcome=repeats, exits=exits, now=since + period)


def with_first_iteration_before_loop(path: Path) -> Path:
    """The same schedule, with the first iteration of its loop before the loop."""
    outcome = path.outcome
    assert isinstance(outcome, Repeats)
    count = len(path.occurrences)
    offset, later = count - outcome.position, path.now - outcome.since
    occurrences = (*path.occurrences, *_delayed(path.occurrences[outcome.position :], later))
    exits = dict(path.exits)
    for position, other in path.exits.items():
        if position >= outcome.position:
            exits[position + offset] = _shifted(other, position, occurrences[: position + offset + 1], later)
    return replaced(path, occurrences=occurrences, outcome=Repeats(count, path.now), exits=exits, now=path.now + later)


def _shifted(path: Path, decision: int, before: tuple[Occurrence, ...], later: int) -> Path:
    """An exit that follows ``before``, the last of which is its decision."""
    offset = len(before) - decision - 1
    occurrences = (*before, *_delayed(path.occurrences[decision + 1 :], later))
    exits = {
        position + offset: _shifted(other, position, occurrences[: position + offset + 1], later)
        for position, other in path.exits.items()
        if position > decision
    }
    return replaced(path, occurrences=occurrences, exits=exits, now=path.now + later)


def _delayed(occurrences: tuple[Occurrence, ...], time: int) -> tuple[Occurrence, ...]:
    return tuple(replaced(occurrence, time=occurrence.time + time) for occurrence in occurrences)


def counting_variables(entry: ProcessClass) -> frozenset[str]:
    """Variables that affect control flow and depend only on such variables and constants, such as those that count
    iterations.
    """
    made_from: dict[str, set[str]] = {}
    unknown: set[str] = set()
    deciding: set[str] = set()
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
                deciding |= _variables(part.condition)
            case ir.Repeat():
                deciding |= _variables(part.until)
            case ir.Choice():
                for branch in part.branches:
                    deciding |= _variables(branch.condition)
            case _:  # No other action decides; interrupts are not fused.
                pass
    pending = set(deciding)
    while pending:
        needed = set().union(*(made_from.get(name, set()) for name in pending)) - deciding
        deciding |= needed
        pending = needed
    return frozenset(deciding - unknown)


def _variables(item: object) -> set[str]:
    return {part.channel for part in parts(item) if isinstance(part, VariableValue)}
