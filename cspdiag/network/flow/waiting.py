"""Where a process may wait: which communications and guards never wait, and which compositions only compute.

There are several sets of names for kinds (``ChannelKind``, ``MediumKind`` of a port, and ``sampled``, ``event`` or
``output`` for an output of the outermost process); a name means the same in all of them.
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
    IterationEnd,
    Join,
    Leave,
    Loop,
    Merge,
    ProcessEnd,
    Raise,
    Resume,
    Select,
    Stop,
    Take,
    Test,
    Unwatch,
    Watch,
)
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.expressions import Expression

READ_AT_ONCE: frozenset[str] = frozenset({"var", "constant"})
"""The kinds from which a value can always be read."""

WRITTEN_AT_ONCE: frozenset[str] = frozenset(
    {"var", "discard", "overwrite", "sampled", "event", "latched", "direct", "output"}
)
"""The kinds that take every value when it is written; the environment takes all outputs."""


def is_always_ready(
    event: ir.Event, kind_of: Callable[[ir.End], str], is_over_at_once: Callable[[Expression], bool] = lambda _: False
) -> bool:
    """Whether a guard is ready whenever its condition holds; ``is_over_at_once`` decides it for the duration of a
    time-out.
    """
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
    """Whether a composition, on every path, neither communicates nor waits nor runs an instance or a parallel."""
    return all(map(_only_computes, flow_of(action).instructions))


def _only_computes(instruction: Instruction) -> bool:
    match instruction:
        case (
            Compute() | Test() | Loop() | IterationEnd() | Merge() | Unwatch() | Abandon() | Resume() | Raise()
            | Enter() | Leave() | ProcessEnd()
        ):  # fmt: skip
            return True
        case Watch():
            return isinstance(instruction.step, ir.CatchException)
        case Call() | Communicate() | Delay() | Fork() | Join() | Select() | Stop() | Take():
            return False
        case _:
            assert_never(instruction)
