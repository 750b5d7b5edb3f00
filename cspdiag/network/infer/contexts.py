"""The contexts of shapes: the kind and the sample instants of the net behind each port, from the outermost process
inwards.

Analyses consider shapes in contexts; equal contexts of a shape are considered only once.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal, TypeAlias, assert_never

from cspdiag.base import Report
from cspdiag.base.record import node
from cspdiag.model.sampling import Sampling
from cspdiag.network.infer.periods import Rates, Samples
from cspdiag.network.ir.expressions import Value
from cspdiag.network.ir.network import ChannelKind
from cspdiag.network.ir.ranges import Range
from cspdiag.network.shapes import (
    Attached,
    Default,
    Discarded,
    InstanceShape,
    Key,
    OwnChannel,
    OwnPort,
    Shape,
    Unresolved,
)

NetKind: TypeAlias = ChannelKind | Literal["sampled", "event", "constant", "discard", "open"]
"""The kind of a net; ``open`` if it is unknown, because the process is checked by itself or an error was reported."""

Surroundings: TypeAlias = Literal["environment", "specification", "unknown"]
"""What the ports of an outermost process are connected to: an environment, which takes every output at once; the
process that is to refine it; or, in a library, something unknown.
"""

Fact: TypeAlias = "tuple[NetKind, Sampling | None]"
Facts: TypeAlias = "dict[Key, Fact]"


@node
class Placed:
    """A shape in a context: the nets behind its ports and channels, and the period of each of its
    submodel instances.
    """

    shape: Shape
    facts: Facts
    samples: Mapping[str, int]
    unknown_samples: frozenset[str]
    """Submodel instances whose sample period is not known although they have one."""
    inside: dict[str, Placed]
    """The process instances by name."""
    parameters: dict[str, Range]
    """The ranges of the arguments of all instances for whole-number parameters, as far as all values are known."""
    given: list[Mapping[str, Value]]
    """The arguments of each instance for all parameters, as far as all values are known."""

    def sampling(self, key: Key) -> Sampling | None:
        """The sample instants of the net at a port or channel."""
        return self.facts[key][1]


class Contexts:
    """All shapes in all contexts in which they occur, enclosing processes first."""

    def __init__(self, rates: Mapping[Shape, Rates], report: Report) -> None:
        self.rates = rates
        self.report = report
        self.placed: list[Placed] = []
        self._known: dict[object, Placed] = {}
        self._pending: list[Placed] = []

    def outermost(self, shape: Shape, surroundings: Surroundings) -> Placed:
        """The outermost process in its context; adds everything inside it."""
        is_open = surroundings != "environment"
        facts: Facts = {}
        for port, _, key in shape.port_elements():
            kind: NetKind = "open" if is_open else "sampled" if port.sampling is not None else "event"
            facts[key] = (kind, port.sampling)
        placed = self._place(shape, facts)
        while self._pending:
            self._fill(self._pending.pop())
        return placed

    def _place(self, shape: Shape, ports: Facts) -> Placed:
        identity = (shape, tuple(ports.values()))
        known = self._known.get(identity)
        if known is None:
            rates = self.rates.get(shape, {})
            facts = dict(ports)
            for key, channel in shape.channels.items():
                rate = rates.get(key)
                kind: NetKind = "open" if channel.excused else channel.kind
                facts[key] = (kind, rate.sampling if rate else None)
            periods = {key: sampling.period for key, (_, sampling) in facts.items() if sampling is not None}
            samples = Samples(shape, rates, periods, self.report)
            known = self._known[identity] = Placed(
                shape=shape,
                facts=facts,
                samples=samples.found,
                unknown_samples=samples.unknown,
                inside={},
                parameters={},
                given=[],
            )
            self.placed.append(known)
            self._pending.append(known)
        return known

    def _fill(self, placed: Placed) -> None:
        for instance in placed.shape.instances.values():
            if not instance.shape.is_submodel:
                placed.inside[instance.name] = self._place(instance.shape, port_facts(placed.facts, instance))


def port_facts(facts: Facts, instance: InstanceShape) -> Facts:
    """The facts of the ports of an instance inside a process with these facts."""
    found: Facts = {}
    for port, element, key in instance.shape.port_elements():
        kind, sampling = _fact(facts, instance.attachments.get(element))
        found[key] = (kind, port.sampling if sampling is None else sampling)
    return found


def _fact(facts: Facts, attached: Attached | None) -> Fact:
    target = None if attached is None else attached.target
    match target:
        case OwnPort(key=key) | OwnChannel(key=key):
            return facts[key]
        case Default():
            return "constant", None
        case Discarded():
            return "discard", None
        case Unresolved() | None:
            return "open", None
        case _:
            assert_never(target)
