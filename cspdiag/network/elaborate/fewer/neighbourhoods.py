"""The neighbourhoods of the elements of a process: what each is connected to, and where in the composition it runs.

Every element of an array of instances or ports, and every repetition of a relationship, has a colour. Two have the same
colour if nothing distinguishes them and what they are connected to, three relationships away: neither the places in the
text that run, read, write or connect them, nor which of two ends of a relationship comes first in a replicator around
both. Colours mean the same in all processes for which one ``Colours`` is used.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from itertools import chain, combinations, product, repeat
from operator import gt, lt
from typing import TypeAlias

from cspdiag.base.record import field_names, node
from cspdiag.model.program import EndLabelSymbol, PortSymbol, Program
from cspdiag.network.elaborate.definitions import Definitions, arguments_of
from cspdiag.network.elaborate.fewer.columns import Column, Repetitions, are_below, chosen, known
from cspdiag.network.elaborate.fewer.varying import Varying
from cspdiag.network.elaborate.sizes import LARGEST_PROCESS
from cspdiag.syntax import ast

ROUNDS = 3

Columns: TypeAlias = "tuple[tuple[tuple[int, ...], ...], ...]"
"""For each array of elements, and for each relationship, a row of numbers for each element or repetition."""

Iterations: TypeAlias = "Mapping[ast.Replicator, Sequence[int]]"
"""The index of each replicator around the use of an element, by element; -1 if it is not used inside that replicator.
"""


class Colours(dict[Hashable, int]):
    """A number for everything that is to be distinguished."""

    def __missing__(self, key: Hashable) -> int:
        self[key] = number = len(self)
        return number

    def each(self, what: Hashable, size: int, columns: Iterable[Iterable[int]]) -> list[int]:
        """A colour for each row of columns of this size."""
        return list(map(self.__getitem__, zip(repeat(what, size), *columns, strict=True)))


class UnknownError(Exception):
    """Something has no neighbourhood that is known from the text alone."""


class _Elements:
    """The elements of an array."""

    def __init__(self, size: int) -> None:
        self.size = size
        self.colours: Sequence[int] = ()
        self.iterations: list[Iterations] = []
        """Where the composition uses them."""
        self.used: list[Sequence[int]] = []
        """The place in the text of each of these uses, by element."""
        self.attached: dict[Hashable, list[int]] = {}
        """The colours of the relationships at them, by port or end; -1 for none."""

    def use(self, place: int, around: Repetitions, indexes: Column) -> None:
        """Notes a use of elements, each once, in the composition."""
        self.used.append(_placed([place] * len(indexes), indexes, self.size))
        self.iterations.append(
            {replicator: _placed(around.of(replicator), indexes, self.size) for replicator in around.counts}
        )


@node
class End:
    """An end of a relationship, in each repetition: instances or elements of a port of the process itself.

    ``port`` is the port of the instances, and ``ports`` its elements if it is an array, counted through all instances.
    """

    elements: _Elements
    indexes: Column
    port: ast.PortName | None
    ports: tuple[_Elements, Column] | None


class Neighbourhoods:
    """The colours of the elements of a program, process by process, callees first."""

    def __init__(self, program: Program, definitions: Definitions, varying: Varying, colours: Colours) -> None:
        self.program = program
        self.definitions = definitions
        self.varying = varying
        self.colours = colours
        self._ports: dict[ast.PortName, Sequence[int]] = {}
        """The colours of the elements of arrays of ports, as their own processes use them."""

    def of(self, definition: ast.ProcessDefinition) -> list[frozenset[int]]:
        """All colours in a process, of each kind of element. Raises UnknownError."""
        return self._coloured(definition)[1]

    def columns_of(self, definition: ast.ProcessDefinition) -> Columns:
        """What the network of a process is made of, row by row. Raises UnknownError."""
        return self._coloured(definition)[0].columns()

    def _coloured(self, definition: ast.ProcessDefinition) -> tuple[_Process, list[frozenset[int]]]:
        process = _Process(self, definition)
        found = process.coloured()
        self._ports.update((port, elements.colours) for port, elements in process.own.items())
        return process, found

    def relationships(self, definition: ast.ProcessDefinition) -> dict[ast.Connection, tuple[int, list[End]]]:
        """The number of repetitions of each relationship of a process, and its ends at instances and at arrays of
        ports. Raises UnknownError.
        """
        return _Process(self, definition).relationships

    def ports_of(self, port: ast.PortName) -> Sequence[int]:
        """The colours of the elements of an array of ports; their positions if the process does not vary."""
        found = self._ports.get(port)
        return range(self.size(port.dimensions)) if found is None else found

    def size(self, dimensions: Sequence[ast.Expression]) -> int:
        """The number of elements of an array of one dimension. Raises UnknownError."""
        found = known(self.program, dimensions[0]) if len(dimensions) == 1 else None
        if found is None or not 1 <= found <= LARGEST_PROCESS:
            raise UnknownError
        return found

    def callee(self, item: ast.Instance) -> ast.ProcessDefinition:
        """The process of an instance. Raises UnknownError."""
        found = self.definitions.instantiated(item)
        if not isinstance(found, ast.ProcessDefinition):
            raise UnknownError
        return found


class _Process:
    """The elements of one process, as its text declares, connects and uses them."""

    def __init__(self, around: Neighbourhoods, definition: ast.ProcessDefinition) -> None:
        self.around = around
        self.program = around.program
        self.definition = definition
        self.instances: dict[ast.Instance, _Elements] = {}
        self.own: dict[ast.PortName, _Elements] = {}
        """Those of its own arrays of ports."""
        self.ports: dict[tuple[ast.Instance, ast.PortName], _Elements] = {}
        """Those of the arrays of ports of its instances."""
        self.relationships: dict[ast.Connection, tuple[int, list[End]]] = {}
        self._counts: list[int] = []
        """The numbers of repetitions inside replicators, in text order."""
        self._arguments: list[Column] = []
        """Those that vary."""
        self._places = 0
        self._read()

    def _read(self) -> None:
        outside = Repetitions(self.program, {})
        for port in (name for ports in self.definition.ports for name in ports.names if name.dimensions):
            self.own[port] = _Elements(self.around.size(port.dimensions))
        communication = self.definition.communication
        declarations = () if communication is None else communication.declarations
        for item in declarations:
            if isinstance(item, ast.Instance):
                self._instance(item)
        self._relate(declarations, outside)
        if self.definition.composition is not None:
            self._compose(self.definition.composition, outside)

    def _instance(self, item: ast.Instance) -> None:
        callee = self.around.callee(item)
        count = item.size.count if isinstance(item.size, ast.Replicator) else item.size
        number = 1 if count is None else self.around.size((count,))
        self.instances[item] = _Elements(number)
        for port in (name for ports in callee.ports for name in ports.names if name.dimensions):
            size = len(self.around.ports_of(port))
            self.ports[item, port] = _Elements(number * size)
        rows = Repetitions(self.program, {item.size: number} if isinstance(item.size, ast.Replicator) else {})
        for _, argument in arguments_of(callee.parameters, item.arguments):
            # Every argument is computed, because one of them may overflow.
            if self.around.varying.is_in(self.program, (argument,)):
                column = rows.column(argument)
                if column is None:
                    raise UnknownError
                self._arguments.append(column)

    def _relate(self, declarations: Iterable[ast.Declaration], around: Repetitions) -> None:
        for item in declarations:
            if isinstance(item, ast.RepeatedDeclarations):
                self._relate(item.declarations, self._within(around, item.replicator))
            elif isinstance(item, ast.Connection):
                self._connect(item, around)
            elif around.counts:
                # Instances, variables and channels of which each repetition has its own.
                raise UnknownError

    def _within(self, around: Repetitions, replicator: ast.Replicator) -> Repetitions:
        within = around.within(replicator)
        if within is None or not 0 <= within.number <= LARGEST_PROCESS:
            raise UnknownError
        if replicator in self.around.varying.symbols and within.counts[replicator] < 2:
            # Two repetitions are related to each other as any two are; a single one is not.
            raise UnknownError
        self._counts.append(within.number)
        return within

    def _connect(self, item: ast.Connection, around: Repetitions) -> None:
        ends = []
        for reference in (*item.sources, *item.sinks):
            end = self._end(reference, around) if isinstance(reference, ast.Reference) else None
            if end is not None:
                ends.append(end)
            elif around.counts and not isinstance(reference, ast.Discard):
                raise UnknownError
        if around.counts and item.label is not None:
            raise UnknownError
        self.relationships[item] = around.number, ends

    def _end(self, reference: ast.Reference, around: Repetitions) -> End | None:
        """The end that a reference names in each repetition; None for an object of which there is one."""
        symbol, member = self.program.bindings.get(reference), self.program.members.get(reference)
        if isinstance(symbol, ast.Instance) and isinstance(member, PortSymbol):
            elements = self.instances[symbol]
            indexes = self._indexes(reference.indexes, elements.size, around, is_array=symbol.size is not None)
            ports = self.ports.get((symbol, member.port))
            if ports is None:
                self._indexes(reference.member_indexes, 1, around, is_array=False)
                return End(elements=elements, indexes=indexes, port=member.port, ports=None)
            size = ports.size // elements.size
            inner = self._indexes(reference.member_indexes, size, around, is_array=True)
            if elements.size > 1:
                inner = [instance * size + index for instance, index in zip(indexes, inner, strict=True)]
            return End(elements=elements, indexes=indexes, port=member.port, ports=(ports, inner))
        if isinstance(symbol, PortSymbol) and symbol.port in self.own:
            elements = self.own[symbol.port]
            indexes = self._indexes(reference.indexes, elements.size, around, is_array=True)
            return End(elements=elements, indexes=indexes, port=None, ports=None)
        if isinstance(symbol, PortSymbol | ast.Variable | ast.Channel | EndLabelSymbol):
            return None
        raise UnknownError

    def _indexes(self, given: Sequence[ast.Expression], size: int, around: Repetitions, *, is_array: bool) -> Column:
        if len(given) != is_array:
            raise UnknownError
        found = around.column(given[0]) if given else [0] * around.number
        if found is None or not are_below(found, size):
            raise UnknownError
        return found

    def _compose(self, composition: ast.Node, outside: Repetitions) -> None:
        """Notes what uses instances and arrays of ports, in text order."""
        pending = [(composition, outside)]
        while pending:
            step, around = pending.pop()
            if isinstance(step, ast.Replicated):
                pending.append((step.process, self._within(around, step.replicator)))
            elif isinstance(step, ast.Reset):
                raise UnknownError
            elif isinstance(step, ast.Reference):
                self._use(step, around)
            else:
                pending += ((inner, around) for inner in reversed(list(_inside(step))))

    def _use(self, reference: ast.Reference, around: Repetitions) -> None:
        symbol = self.program.bindings.get(reference)
        is_array = True
        if isinstance(symbol, ast.Instance):
            elements, is_array = self.instances[symbol], symbol.size is not None
        elif isinstance(symbol, PortSymbol) and symbol.port in self.own:
            elements = self.own[symbol.port]
        elif self.around.varying.is_in(self.program, (reference,)):
            raise UnknownError
        else:
            return
        self._places += 1
        elements.use(self._places, around, self._indexes(reference.indexes, elements.size, around, is_array=is_array))

    def coloured(self) -> list[frozenset[int]]:
        """All colours, after as many rounds as relationships are looked along."""
        colours = self.around.colours
        for item, elements in self.instances.items():
            _require_one_run(elements)
            elements.colours = colours.each(item, elements.size, elements.used)
        for (item, port), elements in self.ports.items():
            inner = chain.from_iterable(repeat(self.around.ports_of(port), self.instances[item].size))
            elements.colours = colours.each((item, port), elements.size, [inner])
        for port, elements in self.own.items():
            columns: list[Iterable[int]] = [*elements.used]
            for one, other in combinations(elements.iterations, 2):
                columns += _order(one, other, range(elements.size), range(elements.size))
            elements.colours = colours.each(port, elements.size, columns)
        rows: dict[ast.Connection, list[int]] = {}
        for _ in range(ROUNDS):
            rows = {item: self._rows(item) for item in self.relationships}
            self._attach(rows)
            self._look_along()
        everything = (*self.instances.values(), *self.ports.values(), *self.own.values())
        return [frozenset(chain.from_iterable(rows.values())), *(frozenset(one.colours) for one in everything)]

    def columns(self) -> Columns:
        """All that decides what each element is in the network, once they are coloured: what is alike, where it runs,
        what is connected to what, and arguments.
        """
        tables: list[list[Iterable[int]]] = [[column] for column in (self._counts, *self._arguments)]
        for elements in (*self.instances.values(), *self.ports.values(), *self.own.values()):
            inside = [column for around in elements.iterations for column in around.values()]
            tables.append([elements.colours, *elements.used, *inside])
        for number, ends in self.relationships.values():
            tables.append([range(number), *(end.indexes for end in ends)])
            tables[-1] += [end.ports[1] for end in ends if end.ports is not None]
        return tuple([tuple(zip(*table, strict=True)) for table in tables])

    def _rows(self, item: ast.Connection) -> list[int]:
        """The colour of each repetition of a relationship."""
        number, ends = self.relationships[item]
        columns: list[Iterable[int]] = []
        for end in ends:
            columns.append(chosen(end.elements.colours, end.indexes))
            if end.ports is not None:
                columns.append(chosen(end.ports[0].colours, end.ports[1]))
        for one, other in combinations(ends, 2):
            for here, there in product(one.elements.iterations, other.elements.iterations):
                columns += _order(here, there, one.indexes, other.indexes)
        return self.around.colours.each(item, number, columns)

    def _attach(self, rows: Mapping[ast.Connection, list[int]]) -> None:
        """Give every element the colours of the relationships at it; a port has one relationship at most."""
        counted: dict[int, int] = {}
        for elements in (*self.instances.values(), *self.ports.values(), *self.own.values()):
            elements.attached = {}
        for item, (_, ends) in self.relationships.items():
            for place, end in enumerate(ends):
                elements, indexes = (end.elements, end.indexes) if end.ports is None else end.ports
                key: Hashable = (item, place) if end.port is None else end.port
                column = elements.attached.setdefault(key, [-1] * elements.size)
                counted[id(column)] = counted.get(id(column), 0) + len(indexes)
                _put(column, indexes, rows[item])
        for elements in (*self.instances.values(), *self.ports.values(), *self.own.values()):
            for column in elements.attached.values():
                if elements.size - column.count(-1) != counted[id(column)]:
                    raise UnknownError

    def _look_along(self) -> None:
        """Each element's next colour: that of itself and of the relationships at it."""
        colours = self.around.colours
        for item, elements in (*self.instances.items(), *self.own.items()):
            columns: list[Iterable[int]] = [elements.colours, *elements.attached.values()]
            elements.colours = colours.each((item, *elements.attached), elements.size, columns)
        for (item, port), elements in self.ports.items():
            owner = self.instances[item]
            of_owner = chain.from_iterable(map(repeat, owner.colours, repeat(elements.size // owner.size)))
            columns = [elements.colours, of_owner, *elements.attached.values()]
            elements.colours = colours.each((item, port, *elements.attached), elements.size, columns)


def _require_one_run(elements: _Elements) -> None:
    """Every instance has to run at one place. Then the uses of its elements become one."""
    number = sum(elements.size - column.count(-1) for column in elements.used)
    together = list(map(max, *elements.used, [-1] * elements.size)) if elements.used else [-1]
    if number != elements.size or -1 in together:
        raise UnknownError
    elements.used = [together]


def _order(one: Iterations, other: Iterations, here: Column, there: Column) -> Iterator[Iterable[int]]:
    """For each replicator around two uses, which of them comes first, row by row."""
    for replicator in (replicator for replicator in one if replicator in other):
        earlier, later = chosen(one[replicator], here), chosen(other[replicator], there)
        yield map(lt, earlier, later)
        yield map(gt, earlier, later)


def _placed(values: Sequence[int], indexes: Column, size: int) -> Sequence[int]:
    """The values at the indexes of a column of this size, and -1 elsewhere. Raises UnknownError for two at one."""
    if isinstance(indexes, range) and indexes == range(size):
        return values
    found = [-1] * size
    for index, value in zip(indexes, values, strict=True):
        if found[index] != -1:
            raise UnknownError
        found[index] = value
    return found


def _put(column: list[int], indexes: Column, values: Sequence[int]) -> None:
    if isinstance(indexes, range) and indexes.step == 1:
        column[indexes.start : indexes.stop] = values
    else:
        for index, value in zip(indexes, values, strict=True):
            column[index] = value


def _inside(step: ast.Node) -> Iterator[ast.Node]:
    """The nodes directly inside a node."""
    for name in field_names(step):
        inner = getattr(step, name)
        for part in inner if isinstance(inner, tuple) else (inner,):
            if isinstance(part, ast.Node):
                yield part
