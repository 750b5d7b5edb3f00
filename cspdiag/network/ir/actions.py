"""What a process does: the composition, resolved, and unrolled but for long sequences of turns, which are loops.

``CoreAction`` is what a text can say; the passes of ``cspdiag.optimize`` make more, and what they give is an
``Action``. What consists of actions is generic in which of the two, ``Action`` where nothing is said: a type checker
then knows who never meets what the optimizer makes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Generic, Literal, TypeAlias

from cspdiag.base import Span
from cspdiag.base.record import record
from cspdiag.model.types import Type
from cspdiag.network.ir.equations import ExternalCall, SubmodelEquation
from cspdiag.network.ir.expressions import Expression

if TYPE_CHECKING:
    from typing_extensions import TypeVar

    A_co = TypeVar("A_co", covariant=True, default="Action")
else:
    from typing import TypeVar

    A_co = TypeVar("A_co", covariant=True)


@record
class PortEnd:
    """A port of the enclosing process class; ``index`` counts in an array of ports.

    ``end`` distinguishes the ends of a port that parallel parts of this process read (each takes every sample or
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
class SequentialSteps(Step, Generic[A_co]):
    """One after another."""

    steps: tuple[A_co, ...]


@record(kw_only=True)
class ParallelSteps(Step, Generic[A_co]):
    """All at once; ``prioritized``: each has a higher priority than those to its right."""

    steps: tuple[A_co, ...]
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
class Branch(Step, Generic[A_co]):
    """A guarded process: the condition that must hold, the event, and what follows."""

    condition: Expression | None
    event: Event
    body: A_co


@record(kw_only=True)
class Choice(Step, Generic[A_co]):
    """An alternative. A guarded process alone is one with a single branch.

    ``name`` is unique in the class once the passes of ``cspdiag.optimize`` have given names.
    """

    branches: tuple[Branch[A_co], ...]
    prioritized: bool
    name: str = ""


@record(kw_only=True)
class Repeat(Step, Generic[A_co]):
    """The mu process: runs the body, then tests; forever without ``until``."""

    body: A_co
    until: Expression | None


@record(kw_only=True)
class WhileLoop(Step, Generic[A_co]):
    """Tests first."""

    condition: Expression
    body: A_co


@record(kw_only=True)
class CountedLoop(Step, Generic[A_co]):
    """A replicated ``seq`` of many turns: runs the body ``turns`` times, which is at least twice.

    Where turns differ by their number, a variable has it, which is set to 0 before the loop and counts at the end of
    the body.
    """

    body: A_co
    turns: int


@record(kw_only=True)
class IfElse(Step, Generic[A_co]):
    """A condition; ``otherwise`` is SkipStep where nothing was said."""

    condition: Expression
    then: A_co
    otherwise: A_co


@record(kw_only=True)
class CatchException(Step, Generic[A_co]):
    """If the exception ends the body, the handler runs."""

    body: A_co
    exception: str
    handler: A_co


@record(kw_only=True)
class InterruptOn(Step, Generic[A_co]):
    """The body is abandoned at its next communication once the branch's guard is ready; then the branch's body runs."""

    body: A_co
    branch: Branch[A_co]


@record(kw_only=True)
class Group(Step, Generic[A_co]):
    """A named group."""

    label: str
    body: A_co


@record(kw_only=True)
class InputRead:
    """One of the reads of ``ReadInputs``: the value becomes the local signal ``name``."""

    source: End
    name: str
    type: Type


@record(kw_only=True)
class ReadInputs(Step):
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
class WriteOutputs(Step):
    """The outputs of an inlined control law: all values are offered at once in this order, then it waits for all.

    It is a point of cancellation, as every communication is, also without any writes. ``law`` is the instance that
    writes.
    """

    writes: tuple[OutputWrite, ...]
    law: str = ""


@record(kw_only=True)
class RunLaw(Step):
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
class ResetStates(Step):
    """Puts states of the class back to their initial values; the name of an ``ExternalCall`` means the ``reset`` of
    what it calls.
    """

    states: tuple[str, ...]


@record(kw_only=True)
class ProcessScope(Step):
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
class ReportCommunication(Step):
    """Tells the trace of a communication on a channel that was optimized away; ``channel`` is its path below this
    class.
    """

    channel: str
    value: Expression


_Leaf: TypeAlias = (
    RunInstance | ReadValue | WriteValue | AssignValue | SkipStep | StopStep | WaitStep | ResetInstance | RaiseException
)
_Composed: TypeAlias = (
    SequentialSteps[A_co]
    | ParallelSteps[A_co]
    | Choice[A_co]
    | Repeat[A_co]
    | WhileLoop[A_co]
    | CountedLoop[A_co]
    | IfElse[A_co]
    | CatchException[A_co]
    | InterruptOn[A_co]
    | Group[A_co]
)
CoreAction: TypeAlias = "_Leaf | _Composed[CoreAction]"
"""What the composition of a text becomes."""

MadeAction: TypeAlias = ReadInputs | WriteOutputs | RunLaw | ResetStates | ProcessScope | ReportCommunication
"""What only the passes of ``cspdiag.optimize`` make."""

Action: TypeAlias = "_Leaf | _Composed[Action] | MadeAction"
"""What a process does before or after these passes."""
