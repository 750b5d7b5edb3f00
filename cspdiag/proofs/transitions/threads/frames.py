"""What a thread has still to do: a stack of frames, the next one first.

Frames are tuples, since stacks are hashed and compared with every step of a thread. Their ``kind`` keeps frames of
different classes apart.
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
"""The guards of an alternative: None where the condition does not hold, else what is written, and whether it may hold.
"""

Stage: TypeAlias = Literal["wait", "cancelling", "failing", "abandon", "abandoned"]
"""Where the parent of a parallel is, see ``join_edges``."""


class Risk(NamedTuple):
    """Stands for a shared variable that is loaded: the fault that ``what`` may end in, which it does not."""

    span: Span | None = None
    what: str = ""


RISK: Final = Risk()


class Run(NamedTuple):
    """An action."""

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
    """The conditions of an alternative are looked at one after the other."""

    node: Node
    context: Context
    decided: Decided
    kind: Literal["deciding"] = "deciding"


class Offering(NamedTuple):
    """A condition of an alternative holds, or may hold: what the guard writes is computed."""

    node: Node
    context: Context
    decided: Decided
    is_open: bool
    kind: Literal["offering"] = "offering"


class Picking(NamedTuple):
    """An alternative with conditions that may hold or not."""

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
    """A control law reads the inputs that remain, by position; None before it is known which have to wait."""

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
    """A control law writes the outputs that remain, by position; None before it is known which have to wait."""

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
    """While it is ``cancelling`` and ``failing``: what is raised."""
    kind: Literal["join"] = "join"


class Interrupting(NamedTuple):
    """The condition of the guard of an interrupt is looked at."""

    node: Node
    context: Context
    kind: Literal["interrupting"] = "interrupting"


class Interruptible(NamedTuple):
    """The condition of the guard of an interrupt holds: what it writes is computed."""

    node: Node
    context: Context
    kind: Literal["interruptible"] = "interruptible"


class Interrupt(NamedTuple):
    """The guard of an interrupt is around all that lies above."""

    node: Node
    context: Context
    value: Known
    kind: Literal["interrupt"] = "interrupt"


class GuardOnly(NamedTuple):
    """The body of an interrupt was abandoned: only its guard is left."""

    node: Node
    context: Context
    value: Known
    kind: Literal["guard only"] = "guard only"


class Closing(NamedTuple):
    """The body of an interrupt is about to end, or to raise an exception."""

    interrupt: Interrupt
    exception: str | None
    kind: Literal["closing"] = "closing"


class Pass(NamedTuple):
    """The guard of an interrupt is looked at here, as where the process waits."""

    node: Node
    kind: Literal["pass"] = "pass"


class Either(NamedTuple):
    """The thread ends here, or goes on."""

    kind: Literal["either"] = "either"


class Open(NamedTuple):
    """A condition that may hold or not."""

    context: Context
    condition: Expression
    then: Stack
    otherwise: Stack
    kind: Literal["open"] = "open"


class Storing(NamedTuple):
    """A variable is given a value."""

    reference: Reference
    value: Known
    kind: Literal["storing"] = "storing"


class Split(NamedTuple):
    """One of these: which is left open."""

    parts: tuple[Put, ...] | tuple[Storing, ...]
    kind: Literal["split"] = "split"


class Load(NamedTuple):
    """A shared variable is to be looked at, or a fault to be risked."""

    what: Reference | Risk
    kind: Literal["load"] = "load"


class Store(NamedTuple):
    """A shared variable is to be given a value."""

    reference: Reference
    value: Known
    kind: Literal["store"] = "store"


class Assign(NamedTuple):
    """What was read goes into its variable."""

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


class Again(NamedTuple):
    """The body of a loop has ended."""

    node: Node
    context: Context
    kind: Literal["again"] = "again"


class Turns(NamedTuple):
    """A counted loop has as many turns left."""

    node: Node
    context: Context
    left: int
    kind: Literal["turns"] = "turns"


class Catch(NamedTuple):
    """What lies above is the body of a ``catch``."""

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
    """It has not been started."""

    kind: Literal["idle"] = "idle"


class Ended(NamedTuple):
    """The thread has ended, and its parent has not been notified."""

    kind: Literal["ended"] = "ended"


class Over(NamedTuple):
    """The thread has ended for good."""

    kind: Literal["over"] = "over"


class Faulted(NamedTuple):
    """The program ends by a fault."""

    kind: Literal["faulted"] = "faulted"


class Raised(NamedTuple):
    """It ends by an exception."""

    exception: str
    kind: Literal["raised"] = "raised"


Silent: TypeAlias = (
    Deciding | Offering | Compute | Interrupting | Interruptible | Interrupt | Storing | Assign | Again | Turns
    | Catch | Leave
)  # fmt: skip
"""What a thread does on its own."""

Partly: TypeAlias = Run | Reading | Writing
"""What it may do on its own."""

Waiting: TypeAlias = (
    Put | Delivering | Withdrawing | Picking | Choosing | Join | GuardOnly | Closing | Pass | Either | Open | Split
    | Load | Store | Foreign | ForeignPort | Diverges | Idle | Ended | Over | Faulted | Raised
)  # fmt: skip
"""What others take part in, may see, or decide by leaving it open."""

Frame: TypeAlias = Silent | Partly | Waiting
Stack: TypeAlias = "tuple[Frame, Stack] | None"

POINTS: frozenset[type[Frame]] = frozenset(
    {Run, Put, Delivering, Choosing, Reading, Writing, Foreign, ForeignPort, Pass, GuardOnly}
)
"""What may be first on the stack where a cancelled or interrupted process ends."""


def is_interruptible(stack: Stack) -> bool:
    """Whether what is to be done stands in an interrupt."""
    while stack is not None:
        frame, stack = stack
        if isinstance(frame, Interrupt):
            return True
    return False
