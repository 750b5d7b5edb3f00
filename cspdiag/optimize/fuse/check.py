"""Whether two schedules are the same, even if their repetition was found at different points."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import zip_longest
from typing import TypeAlias, assert_never

from cspdiag.network.ir.actions import AssignValue, ProcessScope
from cspdiag.optimize.fuse.actions import opposite
from cspdiag.optimize.fuse.code import Failure
from cspdiag.optimize.fuse.follow import Ends, Repeats
from cspdiag.optimize.fuse.record import Decision, Occurrence, Step
from cspdiag.optimize.fuse.schedule import Path


def same_schedule(one: Path, other: Path, ignored: frozenset[str]) -> bool:
    """Whether the same actions occur at the same instants, in the same order, with the same exits.

    Assignments to ``ignored`` variables do not count, nor do the ends of processes, which affect only the samples that
    are taken and missed. Each schedule is a beginning and a loop. Two such sequences that agree over their combined
    length agree forever.
    """
    return _same_from((one, 0, 0), (other, 0, 0), ignored)


Part: TypeAlias = tuple[Path, int, int]
"""A path from a position on, and the instant from which its times count."""


def _same_from(one: Part, other: Part, ignored: frozenset[str]) -> bool:
    path, other_path = one[0], other[0]
    if not _same_end(one, other):
        return False
    length = len(path.occurrences) + len(other_path.occurrences)
    compared: set[tuple[int, int]] = set()
    for here, there in zip_longest(_unrolled(one, length, ignored), _unrolled(other, length, ignored)):
        if here is None or there is None or here[1] != there[1]:
            return False
        (position, _, occurrence), (other_position, _, other_happening) = here, there
        match occurrence, other_happening:
            case Step(action=action), Step(action=other_action):
                if action != other_action:
                    return False
            case Decision(), Decision():
                if not _same_decision(occurrence, other_happening):
                    return False
                places = (position, other_position)
                if places not in compared:
                    compared.add(places)
                    exit_part = (path.exits[position], position + 1, occurrence.time)
                    other_exit = (other_path.exits[other_position], other_position + 1, other_happening.time)
                    if not _same_from(exit_part, other_exit, ignored):
                        return False
            case _:  # One is a step, the other a decision.
                return False
    return True


def _same_end(one: Part, other: Part) -> bool:
    outcome, other_outcome = one[0].outcome, other[0].outcome
    if isinstance(outcome, Repeats) or isinstance(other_outcome, Repeats):
        return isinstance(outcome, Repeats) and isinstance(other_outcome, Repeats)
    return _same_failure(outcome.failure, other_outcome.failure) and one[0].now - one[2] == other[0].now - other[2]


def _same_failure(one: Failure | None, other: Failure | None) -> bool:
    if one is None or other is None:
        return one is other
    processes = [None if failure.process is None else failure.process.instance for failure in (one, other)]
    return one.action == other.action and processes[0] == processes[1]


def _same_decision(one: Decision, other: Decision) -> bool:
    if one.holds != other.holds:
        return opposite(one.condition) == other.condition or one.condition == opposite(other.condition)
    return one.condition == other.condition


def _unrolled(part: Part, length: int, ignored: frozenset[str]) -> Iterator[tuple[int, int, Occurrence]]:
    """The occurrences of a part, each with its position and instant; at most ``length`` of them if the part repeats
    forever.
    """
    path, position, began = part
    shift = -began
    given = 0
    visited = 0
    while given < length and visited < 2 * length + 2:
        if position == len(path.occurrences):
            if isinstance(path.outcome, Ends) or path.outcome.position == position:
                return
            shift += path.now - path.outcome.since
            position = path.outcome.position
        occurrence = path.occurrences[position]
        if not _is_ignored(occurrence, ignored):
            yield position, occurrence.time + shift, occurrence
            given += 1
        position += 1
        visited += 1


def _is_ignored(occurrence: Occurrence, ignored: frozenset[str]) -> bool:
    match occurrence:
        case Step(action=AssignValue(target=target)):
            return target.channel in ignored
        case Step(action=ProcessScope()):
            return True
        case Step() | Decision():
            return False
        case _:
            assert_never(occurrence)
