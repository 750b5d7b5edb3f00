"""What a process does: the composition, resolved, and unrolled but for long sequences of turns that are all the same.

The last few actions are not in the text: the passes of ``network.optimize`` make them.
"""

from __future__ import annotations

from typing import Literal, TypeAlias

from cspdiag.base import Span
from cspdiag.base.record import record
from cspdiag.model.types import Type
from cspdiag.network.ir.equations import ExternalCall, SubmodelEquation
from cspdiag.network.ir.expressions import Expression


@record
class PortEnd:
    """A port of the enclosing process class; ``index`` counts in an array of ports.

    ``end`` tells apart the ends of a port that parallel parts of this process read (each takes every sample or
    broadcast value for itself); parts in sequence share an end.
    """

    port: str
    index: int | None = None
    end: int = 0


@record
class ChannelEnd:
    """A channel that the enclosing process class declares; ``end`` as for ports."""

    channel: str
    end: int = 0


End: TypeAlias = PortEnd | ChannelEnd


@record(kw_only=True)
class Step:
    """Anything in a composition; it has a place."""

    span: Span


@record(kw_only=True)
class RunInstance(Step):
    """Runs an instance of the enclosing class to its end."""

    instance: str


@record(kw_only=True)
class ReadValue(Step):
    """One communication: reads a value into a ``var`` channel of the class."""

    source: End
    target: Target


@record(kw_only=True)
class WriteValue(Step):
    """One communication: writes a value."""

    sink: End
    value: Expression


@record(kw_only=True)
class AssignValue(Step):
    """Sets a ``var`` channel of the class; no communication."""

    target: Target
    value: Expression


@record
class Target:
    """A variable, or an element of it when ``indexes`` are given."""

    channel: str
    indexes: tuple[Expression, ...] = ()


@record(kw_only=True)
class SkipStep(Step):
    """Ends at once."""


@record(kw_only=True)
class StopStep(Step):
    """Never ends."""


@record(kw_only=True)
class WaitStep(Step):
    """A delay; ``duration`` is a ``time``."""

    duration: Expression


@record(kw_only=True)
class ResetInstance(Step):
    """Puts the states of a submodel instance back."""

    instance: str


@record(kw_only=True)
class RaiseException(Step):
    """Ends the process unsuccessfully."""

    exception: str


@record(kw_only=True)
class SequentialSteps(Step):
    """One after another."""

    steps: tuple[Action, ...]


@record(kw_only=True)
class ParallelSteps(Step):
    """All at once; ``prioritized``: each has a higher priority than those to its right."""

    steps: tuple[Action, ...]
    prioritized: bool


@record(kw_only=True)
class ReadyEvent(Step):
    """Ready when a reading end has something; the guarded process begins by reading it."""

    source: End


@record(kw_only=True)
class InputEvent(Step):
    """Reads into a variable."""

    source: End
    target: Target


@record(kw_only=True)
class OutputEvent(Step):
    """Writes a value."""

    sink: End
    value: Expression


@record(kw_only=True)
class AfterEvent(Step):
    """Ready when ``duration`` has passed since the alternative began."""

    duration: Expression


@record(kw_only=True)
class SkipEvent(Step):
    """Always ready."""


Event: TypeAlias = ReadyEvent | InputEvent | OutputEvent | AfterEvent | SkipEvent


@record(kw_only=True)
class Branch(Step):
    """A guarded process: the condition that must hold, the event, and what follows."""

    condition: Expression | None
    event: Event
    body: Action


@record(kw_only=True)
class Choice(Step):
    """An alternative. A guarded process alone is one with a single branch.

    ``name`` is unique in the class once the passes of ``network.optimize`` have given names.
    """

    branches: tuple[Branch, ...]
    prioritized: bool
    name: str = ""


@record(kw_only=True)
class Repeat(Step):
    """The mu process: runs the body, then tests; for ever without ``until``."""

    body: Action
    until: Expression | None


@record(kw_only=True)
class WhileLoop(Step):
    """Tests first."""

    condition: Expression
    body: Action


@record(kw_only=True)
class CountedLoop(Step):
    """A replicated ``seq`` whose turns are all the same: runs the body ``turns`` times, which is at least twice."""

    body: Action
    turns: int


@record(kw_only=True)
class IfElse(Step):
    """A condition; ``otherwise`` is SkipStep where nothing was said."""

    condition: Expression
    then: Action
    otherwise: Action


@record(kw_only=True)
class CatchException(Step):
    """If the exception ends the body, the handler runs."""

    body: Action
    exception: str
    handler: Action


@record(kw_only=True)
class InterruptOn(Step):
    """The body is abandoned at its next communication once the branch's guard is ready; then the branch's body runs."""

    body: Action
    branch: Branch


@record(kw_only=True)
class Group(Step):
    """A named group."""

    label: str
    body: Action


@record(kw_only=True)
class OptimizedStep(Step):
    """A step that only the passes of ``network.optimize`` make; whoever runs before them never meets one."""


@record(kw_only=True)
class InputRead:
    """One of the reads of ``ReadInputs``: the value becomes the local signal ``name``."""

    source: End
    name: str
    type: Type


@record(kw_only=True)
class ReadInputs(OptimizedStep):
    """The inputs of an inlined control law: all reads are begun at once in this order, then it waits for all.

    It is a point of cancellation, as every communication is, also without any reads. ``law`` is the instance that
    reads.
    """

    reads: tuple[InputRead, ...]
    law: str = ""


@record(kw_only=True)
class OutputWrite:
    """One of the writes of ``WriteOutputs``."""

    sink: End
    value: Expression


@record(kw_only=True)
class WriteOutputs(OptimizedStep):
    """The outputs of an inlined control law: all values are offered at once in this order, then it waits for all.

    It is a point of cancellation, as every communication is, also without any writes. ``law`` is the instance that
    writes.
    """

    writes: tuple[OutputWrite, ...]
    law: str = ""


@record(kw_only=True)
class RunLaw(OptimizedStep):
    """One run of an inlined control law, as ``SubmodelClass`` says, on states and constants of the enclosing class.

    ``law`` is the instance's name and the prefix of all its names (``servo.pid.ud``). The equations make local signals,
    which ``WriteOutputs`` after it may use. ``sample`` is the period in seconds that continuous states are integrated
    over. ``doc`` is the comment of the law's definition.
    """

    law: str
    equations: tuple[SubmodelEquation | ExternalCall, ...]
    next_values: tuple[tuple[str, Expression], ...] = ()
    derivative_equations: tuple[SubmodelEquation, ...] = ()
    derivatives: tuple[tuple[str, Expression], ...] = ()
    method: Literal["rk4", "euler"] = "rk4"
    step: int | None = None
    sample: Expression | None = None
    doc: str | None = None


@record(kw_only=True)
class ResetStates(OptimizedStep):
    """Puts states of the class back to their initial values; the name of an ``ExternalCall`` means the ``reset`` of
    what it calls.
    """

    states: tuple[str, ...]


@record(kw_only=True)
class ProcessScope(OptimizedStep):
    """The body of a process that was flattened into this class.

    ``instance`` is its path below this class. ``ends`` are its reading ends: the sampled ones of them with one period
    pace each other, and all are closed when the body ends, in whatever way. ``doc`` is the comment of its definition.
    """

    instance: str
    class_name: str
    ends: tuple[End, ...]
    body: Action
    doc: str | None = None


@record(kw_only=True)
class ReportCommunication(OptimizedStep):
    """Tells the trace of a communication on a channel that was optimized away; ``channel`` is its path below this
    class.
    """

    channel: str
    value: Expression


Action: TypeAlias = (
    RunInstance
    | ReadValue
    | WriteValue
    | AssignValue
    | SkipStep
    | StopStep
    | WaitStep
    | ResetInstance
    | RaiseException
    | SequentialSteps
    | ParallelSteps
    | Choice
    | Repeat
    | WhileLoop
    | CountedLoop
    | IfElse
    | CatchException
    | InterruptOn
    | Group
    | ReadInputs
    | WriteOutputs
    | RunLaw
    | ResetStates
    | ProcessScope
    | ReportCommunication
)
