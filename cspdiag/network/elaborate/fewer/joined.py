"""Which elements of a process are joined by its relationships, in terms of their indexes."""

from __future__ import annotations

from operator import sub

from cspdiag.base.record import node
from cspdiag.model.program import Program
from cspdiag.network.elaborate.definitions import Definitions
from cspdiag.network.elaborate.fewer.columns import Column
from cspdiag.network.elaborate.fewer.neighbourhoods import Colours, End, Neighbourhoods, UnknownError
from cspdiag.network.elaborate.fewer.varying import Varying
from cspdiag.syntax import ast


@node
class Joined:
    """Relationships from a port of instances to others: the index of the sink is that of the source and at least
    ``least``, at most ``most``. A single instance has the index 0.
    """

    source: str
    output: str
    sink: str
    least: int
    most: int


def joined_elements(program: Program, process: ast.ProcessDefinition, varying: Varying) -> list[Joined] | None:
    """The relationships between instances of a process; None if one has several sources or sinks, or elements of arrays
    of ports at its ends.
    """
    try:
        found = Neighbourhoods(program, Definitions(program), varying, Colours()).relationships(process)
        return [each for item, (number, ends) in found.items() if number for each in _joined(program, item, ends)]
    except UnknownError:
        return None


def _joined(program: Program, item: ast.Connection, ends: list[End]) -> list[Joined]:
    """None for a relationship to or from a port of the process itself. Raises UnknownError."""
    references = (*item.sources, *item.sinks)
    symbols = [program.bindings.get(one) for one in references if isinstance(one, ast.Reference)]
    instances = [symbol for symbol in symbols if isinstance(symbol, ast.Instance)]
    if len(references) != 2 or any(end.ports is not None for end in ends):
        raise UnknownError
    if len(instances) < 2:
        return []
    source, sink = ends
    assert source.port is not None
    apart = list(map(sub, *_together(sink.indexes, source.indexes)))
    (first, second), output = (instance.name.text for instance in instances), source.port.name.text
    return [Joined(source=first, output=output, sink=second, least=min(apart), most=max(apart))]


def _together(one: Column, other: Column) -> tuple[Column, Column]:
    """Two columns, or their ends if the difference is the same in between."""
    if isinstance(one, range) and isinstance(other, range) and one.step == other.step:
        return [one[0], one[-1]], [other[0], other[-1]]
    return one, other
