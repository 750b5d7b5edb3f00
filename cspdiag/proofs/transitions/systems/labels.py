"""Labels of the edges of threads. A value is UNKNOWN where it is not followed.

Labels are tuples, since they are numbered and compared for every edge of a thread. Their ``kind`` makes labels of
different classes differ.
"""

from __future__ import annotations

from typing import Literal, NamedTuple, TypeAlias

from cspdiag.proofs.transitions.systems.references import ParallelId, ReadingEnd, Reference
from cspdiag.proofs.transitions.values import Known

Side: TypeAlias = Literal["read", "write"]


class Internal(NamedTuple):
    """A step that others neither take part in nor see."""

    kind: Literal["internal"] = "internal"


class Read(NamedTuple):
    """A communication on a channel, or a value taken from it.

    A ``late`` read is that of the guard of an interrupt whose body is about to end; only an alternative of another
    process can take part in it.
    """

    reference: Reference
    value: Known
    end: ReadingEnd
    late: bool = False
    kind: Literal["read"] = "read"


class Write(NamedTuple):
    """A communication on a channel, or a value put into it."""

    reference: Reference
    value: Known
    kind: Literal["write"] = "write"


class Guarded(NamedTuple):
    """A write by an output guard."""

    reference: Reference
    value: Known
    kind: Literal["guarded"] = "guarded"


class Bind(NamedTuple):
    """An alternative chooses to write to another one, whose ``ready`` guard is taken before it reads."""

    reference: Reference
    kind: Literal["bind"] = "bind"


class Bound(NamedTuple):
    """The other side of ``Bind``."""

    reference: Reference
    kind: Literal["bound"] = "bound"


class Delivered(NamedTuple):
    """The writer of a broadcast continues."""

    reference: Reference
    kind: Literal["delivered"] = "delivered"


class Withdrawn(NamedTuple):
    """The writer of a broadcast was cancelled."""

    reference: Reference
    kind: Literal["withdrawn"] = "withdrawn"


class Input(NamedTuple):
    """An event arrives from outside."""

    reference: Reference
    value: Known
    kind: Literal["input"] = "input"


class Sample(NamedTuple):
    """A sample is taken."""

    reference: Reference
    value: Known
    kind: Literal["sample"] = "sample"


class Miss(NamedTuple):
    """A sample was missed."""

    reference: Reference
    kind: Literal["miss"] = "miss"


class Ready(NamedTuple):
    """A value from outside has arrived, and has not been read yet."""

    reference: Reference
    kind: Literal["ready"] = "ready"


class Output(NamedTuple):
    """A value is written to an output."""

    reference: Reference
    value: Known
    kind: Literal["output"] = "output"


class Time(NamedTuple):
    """A delay ends; it is ``instant`` if it may take no time."""

    words: str
    instant: bool = False
    kind: Literal["time"] = "time"


class Alarm(NamedTuple):
    """The guard of an interrupt sees that another process is ready to communicate on that side of a medium."""

    reference: Reference
    side: Side
    end: ReadingEnd | None
    kind: Literal["alarm"] = "alarm"


class Load(NamedTuple):
    """A shared variable is read."""

    reference: Reference
    value: Known
    kind: Literal["load"] = "load"


class Store(NamedTuple):
    """A shared variable is assigned."""

    reference: Reference
    value: Known
    kind: Literal["store"] = "store"


class Fork(NamedTuple):
    """All branches of a parallel start."""

    parallel: ParallelId
    kind: Literal["fork"] = "fork"


class Join(NamedTuple):
    """All branches of a parallel have ended."""

    parallel: ParallelId
    kind: Literal["join"] = "join"


class Cancel(NamedTuple):
    """All branches of a parallel are cancelled."""

    parallel: ParallelId
    kind: Literal["cancel"] = "cancel"


class Thrown(NamedTuple):
    """A branch of a parallel raises an exception."""

    parallel: ParallelId
    branch: int
    exception: str
    kind: Literal["thrown"] = "thrown"


class Start(NamedTuple):
    """The thread is started, as a branch."""

    kind: Literal["start"] = "start"


class End(NamedTuple):
    """The thread ends, as a branch."""

    kind: Literal["end"] = "end"


class Cancelled(NamedTuple):
    """The thread is cancelled, as a branch."""

    kind: Literal["cancelled"] = "cancelled"


class Throw(NamedTuple):
    """The thread raises an exception, as a branch."""

    exception: str
    kind: Literal["throw"] = "throw"


Offer: TypeAlias = Read | Write | Guarded | Withdrawn
"""What a thread may offer to others, and the withdrawal of it."""

Alone: TypeAlias = Input | Output | Sample | Miss | Ready
"""What involves only the environment."""

OnMedium: TypeAlias = Read | Write | Guarded | Bind | Bound | Delivered | Withdrawn | Load | Store
"""What becomes events of a medium, together with what other threads do on it."""

OfParent: TypeAlias = Fork | Join | Cancel | Thrown
"""What a thread does as the parent of a parallel."""

OfBranch: TypeAlias = Start | End | Cancelled | Throw
"""What a thread does as a branch."""

Label: TypeAlias = Internal | Alone | Time | Alarm | OnMedium | OfParent | OfBranch

INTERNAL: Label = Internal()
