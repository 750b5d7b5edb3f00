"""What has certainly been written before each instruction, and what may be read before it is written."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from functools import reduce
from operator import and_, or_
from types import MappingProxyType

from cspdiag.base.record import record
from cspdiag.network.flow.build import flow_of
from cspdiag.network.flow.code import Call, Code, Instruction, Join, Resume
from cspdiag.network.flow.dataflow import solve
from cspdiag.network.flow.effects import reads, writes
from cspdiag.network.ir.actions import Action, ChannelEnd, Target
from cspdiag.network.ir.expressions import VariableValue


def surely_written(
    code: Code,
    gains: Callable[[Instruction], int],
    *,
    written: int = 0,
    endless: Collection[str] = (),
    completes: bool = False,
) -> list[int | None]:
    """The names that have certainly been written before each instruction, one bit each; None if it is unreachable.

    ``gains`` returns those that an instruction writes; ``written`` have a value at the beginning; ``endless`` are the
    instances that never end. With ``completes``, parts that may be abandoned are taken to end normally, if they can.
    """

    def transfer(index: int, instruction: Instruction, state: int) -> int | None:
        if isinstance(instruction, Call) and instruction.step.instance in endless:
            return None
        return state | gains(instruction)

    def merge(instruction: Instruction, states: list[int]) -> int:
        if isinstance(instruction, Join):
            return reduce(or_, states)
        return states[0] if completes and isinstance(instruction, Resume) else reduce(and_, states)

    return solve(code, written, transfer, merge)


@record
class Run:
    """The variables that an instance reads, and then writes, whenever it is run."""

    reads: frozenset[str]
    writes: frozenset[str]


def read_before_written(
    body: Action,
    variables: Collection[str],
    written: Collection[str] = (),
    runs: Mapping[str, Run] = MappingProxyType({}),
) -> frozenset[str]:
    """The variables that may be read before they are written; ``written`` have a value at the beginning. Of instances
    that are not in ``runs`` nothing is known.

    Assigning an element requires that the array has a value. A part that may be abandoned counts as writing nothing.
    """
    bits = {name: 1 << number for number, name in enumerate(variables)}
    if not bits:
        return frozenset()

    def gains(instruction: Instruction) -> int:
        return reduce(or_, (bits.get(name, 0) for name in _names_written(instruction, runs)), 0)

    code = flow_of(body)
    start = reduce(or_, (bits[name] for name in written), 0)
    early = 0
    for instruction, before in zip(code.instructions, surely_written(code, gains, written=start), strict=True):
        if before is not None:
            needed = reduce(or_, (bits.get(name, 0) for name in _names_read(instruction, runs)), 0)
            early |= needed & ~before
    return frozenset(name for name, bit in bits.items() if early & bit)


def _names_written(instruction: Instruction, runs: Mapping[str, Run]) -> Iterator[str]:
    if isinstance(instruction, Call) and instruction.step.instance in runs:
        yield from runs[instruction.step.instance].writes
    for place in writes(instruction):
        if not (isinstance(place, Target) and place.indexes):
            yield _name(place)


def _names_read(instruction: Instruction, runs: Mapping[str, Run]) -> Iterator[str]:
    if isinstance(instruction, Call) and instruction.step.instance in runs:
        yield from runs[instruction.step.instance].reads
    yield from map(_name, reads(instruction))
    yield from (place.channel for place in writes(instruction) if isinstance(place, Target) and place.indexes)


def _name(place: object) -> str:
    """The name of a variable; empty for a port."""
    return place.channel if isinstance(place, VariableValue | ChannelEnd | Target) else ""
