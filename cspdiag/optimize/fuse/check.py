"""Whether two schedules are the same, wherever each was found to repeat."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import zip_longest
from typing import TypeAlias, assert_never

from cspdiag.network.ir.actions import AssignValue, ProcessScope
from cspdiag.optimize.fuse.actions import opposite
from cspdiag.optimize.fuse.code import Failure
from cspdiag.optimize.fuse.follow import Ends, Loops
from cspdiag.optimize.fuse.record import Happening, Step, Turn
from cspdiag.optimize.fuse.schedule import Path


def same_schedule(one: Path, other: Path, ignored: frozenset[str]) -> bool:
    """Whether the same happens at the same instants, in the same order, with the same exits; assignments to ``ignored``
    variables do not count, nor does where processes end, which shows in the samples that are taken and missed.

    Each is a beginning and a loop. Two such sequences that agree for as long as both are together agree forever.
    """
    return _same_from((one, 0, 0), (other, 0, 0), ignored)


Part: TypeAlias = tuple[Path, int, int]
"""A path from a position on; instants count from the last."""


def _same_from(one: Part, other: Part, ignored: frozenset[str]) -> bool:
    path, other_path = one[0], other[0]
    if not _same_end(one, other):
        return False
    length = len(path.happenings) + len(other_path.happenings)
    compared: set[tuple[int, int]] = set()
    for here, there in zip_longest(_unrolled(one, length, ignored), _unrolled(other, length, ignored)):
        if here is None or there is None or here[1] != there[1]:
            return False
        (position, _, happening), (other_position, _, other_happening) = here, there
        match happening, other_happening:
            case Step(action=action), Step(action=other_action):
                if action != other_action:
                    return False
            case Turn(), Turn():
                if not _same_turn(happening, other_happening):
                    return False
                places = (position, other_position)
                if places not in compared:
                    compared.add(places)
                    exit_part = (path.exits[position], position + 1, happening.time)
                    other_exit = (other_path.exits[other_position], other_position + 1, other_happening.time)
                    if not _same_from(exit_part, other_exit, ignored):
                        return False
            case _:  # A step is no turn.
                return False
    return True


def _same_end(one: Part, other: Part) -> bool:
    outcome, other_outcome = one[0].outcome, other[0].outcome
    if isinstance(outcome, Loops) or isinstance(other_outcome, Loops):
        return isinstance(outcome, Loops) and isinstance(other_outcome, Loops)
    return _same_failure(outcome.failure, other_outcome.failure) and one[0].now - one[2] == other[0].now - other[2]


def _same_failure(one: Failure | None, other: Failure | None) -> bool:
    if one is None or other is None:
        return one is other
    processes = [None if failure.process is None else failure.process.instance for failure in (one, other)]
    return one.action == other.action and processes[0] == processes[1]


def _same_turn(one: Turn, other: Turn) -> bool:
    if one.holds != other.holds:
        return opposite(one.condition) == other.condition or one.condition == opposite(other.condition)
    return one.condition == other.condition


def _unrolled(part: Part, length: int, ignored: frozenset[str]) -> Iterator[tuple[int, int, Happening]]:
    """What happens, with its position and instant; of what continues forever, ``length`` things."""
    path, position, began = part
    shift = -began
    given = 0
    looked_at = 0
    while given < length and looked_at < 2 * length + 2:
        if position == len(path.happenings):
            if isinstance(path.outcome, Ends) or path.outcome.position == position:
                return
            shift += path.now - path.outcome.since
            position = path.outcome.position
        happening = path.happenings[position]
        if not _is_ignored(happening, ignored):
            yield position, happening.time + shift, happening
            given += 1
        position += 1
        looked_at += 1


def _is_ignored(happening: Happening, ignored: frozenset[str]) -> bool:
    match happening:
        case Step(action=AssignValue(target=target)):
            return target.channel in ignored
        case Step(action=ProcessScope()):
            return True
        case Step() | Turn():
            return False
        case _:
            assert_never(happening)
