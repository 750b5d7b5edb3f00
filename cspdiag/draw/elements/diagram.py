"""The elements of a communication diagram, named and related as in the text.

Names share one space within a diagram, as they do in a process: an element's ``key`` is its name (``alignL``,
``feedback``), and elements without a name have a key that cannot be a name of the text. Replicated declarations stay
one element: ``cell[8] : Cell`` is one box, and ``cell[i].output`` one port of it.
"""

from __future__ import annotations

from typing import Literal, TypeAlias

from cspdiag.base import Span
from cspdiag.base.record import record
from cspdiag.model.sampling import Sampling
from cspdiag.network.ir.network import Direction

BoxKind: TypeAlias = Literal["process", "submodel", "driver", "unknown"]
"""``unknown``: the definition is missing, or cannot be read."""

FlowKind: TypeAlias = Literal[
    "var", "sync", "broadcast", "any", "buffer", "overwrite", "sampled", "event", "constant", "discard"
]
"""What carries the values of an arrow: the kind of a channel, or what is connected to a port of the outermost process.
"""


@record(kw_only=True)
class Element:
    """Something that is drawn: its key, its doc comment, and every place in the text that it represents."""

    key: str
    doc: str | None = None
    spans: tuple[Span, ...] = ()

    uncompared = frozenset({"span", "spans"})


@record(kw_only=True)
class BoxPort(Element):
    """A port at the edge of a box: ``feedback``, or ``[i + 1].input`` for an element of an array of instances.

    ``default`` is the value that it takes if it is not connected. ``period`` is as written, ``periods`` are its values.
    """

    direction: Direction
    type: str
    period: str | None = None
    periods: tuple[Sampling, ...] = ()
    default: str | None = None
    is_connected: bool = True

    @property
    def name(self) -> str:
        """The name of the port in its definition: ``input`` of ``[i + 1].input[2]``."""
        return self._member.partition("[")[0]

    @property
    def index(self) -> str:
        """Which element of an array of ports it is: ``[2]`` of ``[i + 1].input[2]``; nothing for a single port."""
        return self._member[len(self.name) :]

    @property
    def _member(self) -> str:
        return self.key.rpartition("].")[2] if self.key.startswith("[") else self.key


@record(kw_only=True)
class Box(Element):
    """An instance; in the diagram of an environment also the process.

    ``size`` is what is written between the brackets of an array (``8``, ``i < 8``). ``language`` is that of a
    hand-written body. ``samples`` are the periods in nanoseconds at which a submodel runs. ``inside`` is drawn within
    the box, if requested.
    """

    kind: BoxKind
    definition: str
    arguments: tuple[str, ...] = ()
    size: str | None = None
    language: str | None = None
    definition_doc: str | None = None
    samples: tuple[int, ...] = ()
    ports: tuple[BoxPort, ...] = ()
    inside: CommunicationDiagram | None = None


@record(kw_only=True)
class ParentPort(Element):
    """A port of the process that the diagram belongs to, drawn as a name at the end of arrows:
    ``feedback: double<rad> @T``.

    ``size`` is that of an array, in brackets.
    """

    direction: Direction
    type: str
    size: str | None = None
    kinds: tuple[FlowKind, ...] = ()
    period: str | None = None
    periods: tuple[Sampling, ...] = ()
    immediate: bool = False
    default: str | None = None
    safe: str | None = None


@record(kw_only=True)
class Store(Element):
    """A communication object with a name of its own: a variable, a label that ends an arrow, or a declared channel."""

    form: Literal["variable", "label", "channel"]
    type: str
    initial: str | None = None
    requested: str | None = None
    kinds: tuple[FlowKind, ...] = ()
    capacity: str | None = None


@record(kw_only=True)
class WrittenValue(Element):
    """An expression that the process itself writes: ``control ! 0<V>``."""

    text: str


@record(kw_only=True)
class Sink(Element):
    """``_``: takes everything."""


Vertex: TypeAlias = Box | ParentPort | Store | WrittenValue | Sink


@record
class End:
    """Where an arrow begins or ends: an element, and the port of a box."""

    element: str
    port: str | None = None

    def __str__(self) -> str:
        return self.element if self.port is None else f"{self.element}{'' if self.port[0] == '[' else '.'}{self.port}"


@record(kw_only=True)
class Arrow(Element):
    """A communication relationship, or (``by_composition``) a reader or writer of the process itself.

    ``label`` and ``type`` are those of the communication object; ``repeated`` are the replicators around it (``i <
    n``). ``kinds`` has the inferred kinds: none if nothing is known, several if instances of the process differ.
    ``requested`` is the kind as written.
    """

    sources: tuple[End, ...]
    sinks: tuple[End, ...]
    label: str | None = None
    type: str | None = None
    requested: str | None = None
    kinds: tuple[FlowKind, ...] = ()
    capacity: str | None = None
    periods: tuple[Sampling, ...] = ()
    repeated: tuple[str, ...] = ()
    by_composition: bool = False


@record(kw_only=True)
class CommunicationDiagram(Element):
    """The communication diagram of a process or an environment; ``key`` is its name.

    ``parameters`` are as written; ``environment_of`` is the process that an environment is for.
    """

    parameters: tuple[str, ...] = ()
    environment_of: str | None = None
    vertices: tuple[Vertex, ...] = ()
    arrows: tuple[Arrow, ...] = ()

    @property
    def boxes(self) -> tuple[Box, ...]:
        """The instances, in text order."""
        return tuple(vertex for vertex in self.vertices if isinstance(vertex, Box))

    def elements(self) -> tuple[Element, ...]:
        """Everything that has a key, except the ports of boxes."""
        return (*self.vertices, *self.arrows)
