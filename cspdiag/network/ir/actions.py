"""Actions: the composition of a process, resolved, and unrolled except for long sequences of iterations, which are
loops.

``CoreAction`` is what a program text can express; the passes of ``cspdiag.optimize`` make further actions, and their
results are of type ``Action``. Types that consist of actions are generic in which of the two they contain, by default
``Action``: so a type checker knows which code never has to handle actions made by the optimizer.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Generic, Literal, TypeAlias

from cspdiag.base import Span
from cspdiag.base.record import Slotted, record
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
class PortEnd(Slotted):
    """A port of the enclosing process class; ``index`` counts in an array of ports.

    ``end`` distinguishes the reading ends of a port in parallel parts of this process, each of which gets every sample
    or broadcast value; parts in sequence share an end.
    """

    port: str
    index: int | None = None
    end: int = 0


@record
class ChannelEnd(Slotted):
    """A channel that the enclosing process class declares; ``end`` as for ports."""

    channel: str
    end: int = 0


End: TypeAlias = PortEnd | ChannelEnd


@record(kw_only=True)
class Step:
    """Any part of a composition, with its place in the text."""

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
    """Assigns to a ``var`` channel of the class; this is not a communication."""

    target: Target
    value: Expression


@record
class Target:
    """A variable, or with ``indexes`` an element of it."""

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
    """Resets the states of a submodel instance to their initial values."""

    instance: str


@record(kw_only=True)
class RaiseException(Step):
    """Raises an exception."""

    exception: str


@record(kw_only=True)
class SequentialSteps(Step, Generic[A_co]):
    """Runs its steps one after another."""

    steps: tuple[A_co, ...]


@record(kw_only=True)
class ParallelSteps(Step, Generic[A_co]):
    """Runs its steps in parallel; if ``prioritized``, each has a higher priority than those after it."""

    steps: tuple[A_co, ...]
    prioritized: bool


@record(kw_only=True)
class ReadyEvent(Step):
    """Ready when a value is at a reading end; the guarded process begins by reading it."""

    source: End


@record(kw_only=True)
class InputEvent(Step):
    """Reads a value into a variable."""

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
    """An alternative. A single guarded process is an alternative with one branch.

    ``name`` is unique in the class once the passes of ``cspdiag.optimize`` have given names.
    """

    branches: tuple[Branch[A_co], ...]
    prioritized: bool
    name: str = ""


@record(kw_only=True)
class Repeat(Step, Generic[A_co]):
    """The ``mu`` loop: runs the body, then tests ``until``; without it, forever."""

    body: A_co
    until: Expression | None


@record(kw_only=True)
class WhileLoop(Step, Generic[A_co]):
    """The ``while`` loop: tests the condition, then runs the body."""

    condition: Expression
    body: A_co


@record(kw_only=True)
class CountedLoop(Step, Generic[A_co]):
    """A replicated ``seq`` with many iterations: runs the body ``iterations`` times, at least twice.

    If iterations differ by their index, a variable holds it, which is set to 0 before the loop and incremented at the
    end of the body.
    """

    body: A_co
    iterations: int


@record(kw_only=True)
class IfElse(Step, Generic[A_co]):
    """Runs one of two actions, as a condition decides; ``otherwise`` is SkipStep if the text has no ``else``."""

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
    """The inputs of an inlined control law: all reads begin at once, in this order, and then it waits for all of them.

    Like every communication it is a cancellation point, even without any reads. ``law`` is the instance that reads.
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
    """The outputs of an inlined control law: all values are offered at once, in this order, and then it waits for all
    of them.

    Like every communication it is a cancellation point, even without any writes. ``law`` is the instance that writes.
    """

    writes: tuple[OutputWrite, ...]
    law: str = ""


@record(kw_only=True)
class RunLaw(Step):
    """One run of an inlined control law, as in ``SubmodelClass``, on states and constants of the enclosing class.

    ``law`` is the name of the instance and the prefix of all its names (``servo.pid.ud``). The equations compute local
    signals, which a following ``WriteOutputs`` may use. ``sample`` is the period in seconds that continuous states are
    integrated over. ``doc`` is the comment of the law's definition.
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
    """Resets states of the class to their initial values; the name of an ``ExternalCall`` means the ``reset`` of the
    body that it calls.
    """

    states: tuple[str, ...]


@record(kw_only=True)
class ProcessScope(Step):
    """The body of a process that was flattened into this class.

    ``instance`` is its path below this class. ``ends`` are its reading ends: sampled ones with the same period follow
    it together, and the sessions of all of them end when the body ends, however it does. ``doc`` is the comment of its
    definition.
    """

    instance: str
    class_name: str
    ends: tuple[End, ...]
    body: Action
    doc: str | None = None


@record(kw_only=True)
class ReportCommunication(Step):
    """Records a communication on a channel that was optimized away in the trace; ``channel`` is its path below this
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
"""An action that the composition of a text can become."""

MadeAction: TypeAlias = ReadInputs | WriteOutputs | RunLaw | ResetStates | ProcessScope | ReportCommunication
"""An action that only the passes of ``cspdiag.optimize`` make."""

Action: TypeAlias = "_Leaf | _Composed[Action] | MadeAction"
"""Any action, before or after these passes."""
