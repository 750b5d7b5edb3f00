"""What was surely written before each instruction, and what may be read before it was."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from functools import reduce
from operator import and_, or_

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
    """The names that were surely written before each instruction, a bit each; None where it is never reached.

    ``gains`` are those that an instruction writes, ``written`` those that have a value at the beginning, ``endless``
    the instances that never end. With ``completes`` what may be abandoned is taken to come to its end, if it has one.
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


def read_before_written(body: Action, variables: Collection[str], written: Collection[str] = ()) -> frozenset[str]:
    """Those of the variables that may be read before they were written; ``written`` have a value at the beginning.

    To set an element takes that the array has a value. Nothing is taken for granted of what may be abandoned.
    """
    bits = {name: 1 << number for number, name in enumerate(variables)}

    def gains(instruction: Instruction) -> int:
        names = (_name(place) for place in writes(instruction) if not (isinstance(place, Target) and place.indexes))
        return reduce(or_, (bits.get(name, 0) for name in names), 0)

    code = flow_of(body)
    start = reduce(or_, (bits[name] for name in written), 0)
    early = 0
    for instruction, before in zip(code.instructions, surely_written(code, gains, written=start), strict=True):
        if before is not None:
            needed = reduce(or_, (bits.get(name, 0) for name in _names_read(instruction)), 0)
            early |= needed & ~before
    return frozenset(name for name, bit in bits.items() if early & bit)


def _names_read(instruction: Instruction) -> Iterator[str]:
    yield from map(_name, reads(instruction))
    yield from (place.channel for place in writes(instruction) if isinstance(place, Target) and place.indexes)


def _name(place: object) -> str:
    """The variable that it may be; ports are none."""
    return place.channel if isinstance(place, VariableValue | ChannelEnd | Target) else ""
