"""What a thread still has to do: a stack of frames, the next one on top.

Frames are tuples, since stacks are hashed and compared with every step of a thread. Their ``kind`` makes frames of
different classes differ.
"""

from __future__ import annotations

from typing import Final, Literal, NamedTuple, TypeAlias

from cspdiag.base import Span
from cspdiag.network.ir.actions import Target
from cspdiag.network.ir.expressions import Expression
from cspdiag.proofs.transitions.classes.program import Node
from cspdiag.proofs.transitions.systems.references import Reference
from cspdiag.proofs.transitions.threads.context import Context
from cspdiag.proofs.transitions.values import Known

Decided: TypeAlias = "tuple[tuple[Known, bool] | None, ...]"
"""The guards of an alternative so far: None for one whose condition does not hold; otherwise what it writes, and
whether it is left open that the condition holds.
"""

Stage: TypeAlias = Literal["wait", "cancelling", "failing", "abandon", "abandoned"]
"""What the parent of a parallel is doing; see ``join_edges``."""


class Risk(NamedTuple):
    """Takes the place of a shared variable in ``Load``: the fault that ``what`` may end in. Once it is loaded, the
    fault does not happen.
    """

    span: Span | None = None
    what: str = ""


RISK: Final = Risk()


class Run(NamedTuple):
    """An action is to be run."""

    node: Node
    context: Context
    kind: Literal["run"] = "run"


class Put(NamedTuple):
    """A value is to be written."""

    reference: Reference
    value: Known
    node: Node
    kind: Literal["put"] = "put"


class Delivering(NamedTuple):
    """The writer of a broadcast waits until every end has taken the value."""

    reference: Reference
    node: Node | None
    kind: Literal["delivering"] = "delivering"


class Withdrawing(NamedTuple):
    """The writer of a broadcast takes the value back."""

    reference: Reference
    kind: Literal["withdrawing"] = "withdrawing"


class Deciding(NamedTuple):
    """The conditions of an alternative are evaluated one after the other."""

    node: Node
    context: Context
    decided: Decided
    kind: Literal["deciding"] = "deciding"


class Offering(NamedTuple):
    """A condition of an alternative holds, or may hold: the value that its guard writes is computed."""

    node: Node
    context: Context
    decided: Decided
    is_open: bool
    kind: Literal["offering"] = "offering"


class Picking(NamedTuple):
    """In an alternative it is left open which of some conditions hold."""

    node: Node
    context: Context
    decided: Decided
    kind: Literal["picking"] = "picking"


class Choosing(NamedTuple):
    """An alternative waits for its guards."""

    node: Node
    context: Context
    decided: Decided
    kind: Literal["choosing"] = "choosing"


class Reading(NamedTuple):
    """A control law reads its remaining inputs, by position; None before it is known which inputs it may have to wait
    for.
    """

    context: Context
    instance: str
    node: Node
    remaining: tuple[int, ...] | None
    kind: Literal["reading"] = "reading"


class Compute(NamedTuple):
    """A control law computes."""

    context: Context
    instance: str
    node: Node
    kind: Literal["compute"] = "compute"


class Writing(NamedTuple):
    """A control law writes its remaining outputs, by position; None before it is known which outputs are
    communications.
    """

    context: Context
    instance: str
    node: Node
    remaining: tuple[int, ...] | None
    kind: Literal["writing"] = "writing"


class Join(NamedTuple):
    """The parent of a parallel waits for its branches."""

    node: Node
    context: Context
    stage: Stage
    exception: str | None = None
    """The exception that is raised at the end of ``cancelling`` and ``failing``."""
    kind: Literal["join"] = "join"


class Interrupting(NamedTuple):
    """The condition of the guard of an interrupt is evaluated."""

    node: Node
    context: Context
    kind: Literal["interrupting"] = "interrupting"


class Interruptible(NamedTuple):
    """The condition of the guard of an interrupt holds: the value that the guard writes is computed."""

    node: Node
    context: Context
    kind: Literal["interruptible"] = "interruptible"


class Interrupt(NamedTuple):
    """All frames above this one are the body of an interrupt."""

    node: Node
    context: Context
    value: Known
    kind: Literal["interrupt"] = "interrupt"


class GuardOnly(NamedTuple):
    """The body of an interrupt was abandoned; the process waits for the guard alone."""

    node: Node
    context: Context
    value: Known
    kind: Literal["guard only"] = "guard only"


class Closing(NamedTuple):
    """The body of an interrupt is about to end, or to raise an exception."""

    interrupt: Interrupt
    exception: str | None
    kind: Literal["closing"] = "closing"


class InterruptPoint(NamedTuple):
    """The guards of the surrounding interrupts may be taken here although the process does not wait."""

    node: Node
    kind: Literal["interrupt point"] = "interrupt point"


class MayEnd(NamedTuple):
    """The thread ends here or continues: which, is left open."""

    kind: Literal["may end"] = "may end"


class Open(NamedTuple):
    """A condition is evaluated whose result is left open."""

    context: Context
    condition: Expression
    then: Stack
    otherwise: Stack
    kind: Literal["open"] = "open"


class Storing(NamedTuple):
    """A variable is assigned."""

    reference: Reference
    value: Known
    kind: Literal["storing"] = "storing"


class Split(NamedTuple):
    """One of these frames follows: which one, is left open."""

    parts: tuple[Put, ...] | tuple[Storing, ...]
    kind: Literal["split"] = "split"


class Load(NamedTuple):
    """A shared variable is to be read, or it is to be decided whether a fault happens."""

    what: Reference | Risk
    kind: Literal["load"] = "load"


class Store(NamedTuple):
    """A shared variable is to be assigned."""

    reference: Reference
    value: Known
    kind: Literal["store"] = "store"


class Assign(NamedTuple):
    """A value that was read is assigned to its variable."""

    context: Context
    target: Target
    value: Known
    kind: Literal["assign"] = "assign"


class Foreign(NamedTuple):
    """A process in another language, which may do anything."""

    context: Context
    node: Node | None
    kind: Literal["foreign"] = "foreign"


class ForeignPort(NamedTuple):
    """A process in another language communicates on a port."""

    context: Context
    element: tuple[str, int | None]
    node: Node | None
    kind: Literal["foreign port"] = "foreign port"


class LoopEnd(NamedTuple):
    """The body of a loop has ended."""

    node: Node
    context: Context
    kind: Literal["loop end"] = "loop end"


class Iterations(NamedTuple):
    """A counted loop has ``left`` iterations left."""

    node: Node
    context: Context
    left: int
    kind: Literal["iterations"] = "iterations"


class Catch(NamedTuple):
    """All frames above this one are the body of a ``catch``."""

    exception: str
    handler: Node
    context: Context
    kind: Literal["catch"] = "catch"


class Leave(NamedTuple):
    """A process ends."""

    context: Context
    kind: Literal["leave"] = "leave"


class Diverges(NamedTuple):
    """The thread loops forever without a communication."""

    kind: Literal["diverges"] = "diverges"


class Idle(NamedTuple):
    """The thread has not been started."""

    kind: Literal["idle"] = "idle"


class Ended(NamedTuple):
    """The thread has ended, and its parent has not noticed it yet."""

    kind: Literal["ended"] = "ended"


class Over(NamedTuple):
    """The thread has ended, and will not be started again."""

    kind: Literal["over"] = "over"


class Faulted(NamedTuple):
    """A fault that no process catches has ended the program."""

    kind: Literal["faulted"] = "faulted"


class Raised(NamedTuple):
    """The thread has ended by an exception."""

    exception: str
    kind: Literal["raised"] = "raised"


Silent: TypeAlias = (
    Deciding | Offering | Compute | Interrupting | Interruptible | Interrupt | Storing | Assign | LoopEnd | Iterations
    | Catch | Leave
)  # fmt: skip
"""What a thread does by itself."""

Partly: TypeAlias = Run | Reading | Writing
"""What a thread does by itself, or what others take part in, depending on the action or the connections."""

Waiting: TypeAlias = (
    Put | Delivering | Withdrawing | Picking | Choosing | Join | GuardOnly | Closing | InterruptPoint | MayEnd | Open
    | Split | Load | Store | Foreign | ForeignPort | Diverges | Idle | Ended | Over | Faulted | Raised
)  # fmt: skip
"""What others take part in or may see, and what is left open."""

Frame: TypeAlias = Silent | Partly | Waiting
Stack: TypeAlias = "tuple[Frame, Stack] | None"

CANCELLATION_POINTS: frozenset[type[Frame]] = frozenset(
    {Run, Put, Delivering, Choosing, Reading, Writing, Foreign, ForeignPort, InterruptPoint, GuardOnly}
)
"""The cancellation points: a cancelled or interrupted process ends when one of these is on top of the stack."""


def is_interruptible(stack: Stack) -> bool:
    """Whether the top of a stack is inside an interrupt."""
    while stack is not None:
        frame, stack = stack
        if isinstance(frame, Interrupt):
            return True
    return False
