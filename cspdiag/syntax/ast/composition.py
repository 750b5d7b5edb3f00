"""The composition diagram."""

from __future__ import annotations

from typing import Literal, TypeAlias

from cspdiag.base import Span
from cspdiag.base.record import node
from cspdiag.syntax.ast.expressions import Expression, Identifier, Node, Reference, Replicator


@node
class Step(Node):
    """A part of a composition; ``inner_span`` is its span without the parentheses around it, if there are any."""

    inner_span: Span | None = None

    @property
    def parenthesized(self) -> bool:
        """Whether it is in parentheses in the text."""
        return self.inner_span is not None

    @property
    def place(self) -> Span:
        """Where the step itself is, without parentheses around it."""
        return self.inner_span or self.span


@node
class Run(Step):
    """The name of an instance, which is run."""

    instance: Reference


@node
class Read(Step):
    """``port ? x``."""

    channel: Reference
    target: Reference


@node
class Write(Step):
    """``port ! e``."""

    channel: Reference
    value: Expression


@node
class Assign(Step):
    """``x := e``."""

    target: Reference
    value: Expression


@node
class Skip(Step):
    """``skip``, which ends immediately."""


@node
class Stop(Step):
    """``stop``, which never ends."""


@node
class Wait(Step):
    """``wait 5 ms``; ``wait until t``, where ``time`` is the instant at which it ends."""

    time: Expression
    until: bool


@node
class Reset(Step):
    """``reset name``: resets the states of an instance of a submodel to their initial values."""

    instance: Reference


@node
class Raise(Step):
    """``raise Name``."""

    exception: Identifier


@node
class Sequence(Step):
    """``P ; Q ; ...``, at least two."""

    processes: tuple[Composition, ...]


@node
class Parallel(Step):
    """``P || Q || ...`` or, prioritized, ``P ||> Q ||> ...``."""

    prioritized: bool
    processes: tuple[Composition, ...]


@node
class Alternative(Step):
    """``P [] Q [] ...`` or, prioritized, ``P []> Q []> ...``; every branch is a guarded process or a replicated
    alternative.
    """

    prioritized: bool
    branches: tuple[Composition, ...]


@node
class ReadyGuard(Node):
    """``port -> P``: ready when the port is; the guarded process begins by reading it."""

    channel: Reference


@node
class InputGuard(Node):
    """``port ? x -> P``: reads."""

    channel: Reference
    target: Reference


@node
class OutputGuard(Node):
    """``port ! e -> P``: writes."""

    channel: Reference
    value: Expression


@node
class TimeGuard(Node):
    """``after 5 ms -> P``: a time-out; ``at t -> P``, where ``time`` is the instant from which it is ready."""

    time: Expression
    at: bool


@node
class SkipGuard(Node):
    """``skip -> P``: always ready."""


Event: TypeAlias = ReadyGuard | InputGuard | OutputGuard | TimeGuard | SkipGuard


@node
class Guard(Node):
    """``[when condition &] event``."""

    condition: Expression | None
    event: Event


@node
class Guarded(Step):
    """``guard -> P``."""

    guard: Guard
    process: Composition


@node
class Mu(Step):
    """``mu P until e`` or ``mu P``."""

    process: Composition
    until: Expression | None


@node
class While(Step):
    """``while e do P``."""

    condition: Expression
    process: Composition


@node
class If(Step):
    """``if e then P else Q``."""

    condition: Expression
    then: Composition
    otherwise: Composition | None


@node
class Catch(Step):
    """``P catch Timeout -> Q``."""

    process: Composition
    exception: Identifier
    handler: Composition


@node
class Interrupt(Step):
    """``P interrupt g -> Q``."""

    process: Composition
    guard: Guard
    handler: Composition


ReplicatedOperator: TypeAlias = Literal["seq", "par", "pripar", "alt", "prialt"]


@node
class Replicated(Step):
    """``par i < N : P``."""

    operator: ReplicatedOperator
    replicator: Replicator
    process: Composition


@node
class Labelled(Step):
    """``label: P``."""

    label: Identifier
    process: Composition


Composition: TypeAlias = (
    Run
    | Read
    | Write
    | Assign
    | Skip
    | Stop
    | Wait
    | Reset
    | Raise
    | Sequence
    | Parallel
    | Alternative
    | Guarded
    | Mu
    | While
    | If
    | Catch
    | Interrupt
    | Replicated
    | Labelled
)
