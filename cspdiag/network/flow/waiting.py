"""Where a process may wait: which communications and guards never do, and which compositions do nothing but compute.

Kinds of channels have several vocabularies (``ChannelKind``, ``MediumKind`` of a port, and ``sampled``, ``event`` and
``output`` for what an output of the outermost process is called elsewhere); a name means the same in all of them.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import assert_never

from cspdiag.network.flow.build import flow_of
from cspdiag.network.flow.code import (
    Abandon,
    Call,
    Communicate,
    Compute,
    Delay,
    Enter,
    Fork,
    Instruction,
    Join,
    Leave,
    Loop,
    Meet,
    ProcessEnd,
    Raise,
    Resume,
    Select,
    Stop,
    Take,
    Test,
    Turn,
    Unwatch,
    Watch,
)
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.expressions import Expression

READ_AT_ONCE: frozenset[str] = frozenset({"var", "constant"})
"""The kinds of which a value can always be read."""

WRITTEN_AT_ONCE: frozenset[str] = frozenset(
    {"var", "discard", "overwrite", "sampled", "event", "latched", "direct", "output"}
)
"""The kinds that take every value when it is written: the outside takes all outputs."""


def is_always_ready(
    event: ir.Event, kind_of: Callable[[ir.End], str], is_over_at_once: Callable[[Expression], bool] = lambda _: False
) -> bool:
    """Whether a guard is ready whenever it counts; ``is_over_at_once`` says so of the duration of a time-out."""
    match event:
        case ir.SkipEvent():
            return True
        case ir.ReadyEvent() | ir.InputEvent():
            return kind_of(event.source) in READ_AT_ONCE
        case ir.OutputEvent():
            return kind_of(event.sink) in WRITTEN_AT_ONCE
        case ir.AfterEvent():
            return is_over_at_once(event.duration)
        case _:
            assert_never(event)


def only_computes(action: ir.Action) -> bool:
    """Whether a composition neither communicates nor waits, nor leaves that to others, on any of its ways."""
    return all(map(_only_computes, flow_of(action).instructions))


def _only_computes(instruction: Instruction) -> bool:
    match instruction:
        case (
            Compute() | Test() | Loop() | Turn() | Meet() | Unwatch() | Abandon() | Resume() | Raise() | Enter()
            | Leave() | ProcessEnd()
        ):  # fmt: skip
            return True
        case Watch():
            return isinstance(instruction.step, ir.CatchException)
        case Call() | Communicate() | Delay() | Fork() | Join() | Select() | Stop() | Take():
            return False
        case _:
            assert_never(instruction)
