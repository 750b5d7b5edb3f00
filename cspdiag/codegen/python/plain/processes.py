"""Process classes as Python modules."""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache

from cspdiag.codegen.python.plain.composition.actions import Composition
from cspdiag.codegen.python.plain.constructors import ConstructorWriter
from cspdiag.codegen.python.plain.docs import class_doc
from cspdiag.codegen.python.plain.expressions import Printer
from cspdiag.codegen.python.plain.external import ExternalModules
from cspdiag.codegen.python.plain.instances import Instances
from cspdiag.codegen.python.plain.members import Members
from cspdiag.codegen.python.text.code import (
    SELF,
    Code,
    Comprehension,
    Constant,
    Name,
    call,
    own,
)
from cspdiag.codegen.python.text.imports import Imports
from cspdiag.codegen.python.text.literals import docstring, quoted
from cspdiag.codegen.python.text.modules import ClassModule
from cspdiag.codegen.python.text.names import PackageNames
from cspdiag.codegen.python.text.splitting import methods
from cspdiag.codegen.python.text.statements import Function, Statement, Statements, assign, run
from cspdiag.network.checks.unwritten import may_be_unwritten
from cspdiag.network.ir.actions import ChannelEnd, PortEnd
from cspdiag.network.ir.expressions import ParameterValue, TunableValue
from cspdiag.network.ir.network import CoreClass, Network
from cspdiag.network.ir.walk import parts


@lru_cache(maxsize=1)
def _unwritten(network: Network) -> dict[str, frozenset[str]]:
    return may_be_unwritten(network)


def process_module(process: CoreClass, network: Network, names: PackageNames, modules: ExternalModules) -> ClassModule:
    """The module of a process class."""
    return _ProcessWriter(process, network, names, modules).module()


class _ProcessWriter(ConstructorWriter):
    process: CoreClass

    def __init__(self, process: CoreClass, network: Network, names: PackageNames, modules: ExternalModules) -> None:
        self.process = process
        self.network = network
        self.names = names
        self.members = Members(process, network)
        local = set(self.members.arguments.values())
        self.imports = Imports(names, taken=local)
        self.place = names.place(process.span.file, process.span.line)
        initial = Printer(self.imports, parameter=self._argument)
        running = Printer(self.imports, parameter=self._parameter, variable=self._variable)
        self.initial = initial
        self.instances = Instances(network, self.members, initial, self.imports, modules)
        unwritten = _unwritten(network)[process.name]
        self.composition = Composition(self.members, running, initial, self.imports, unwritten)

    def module(self) -> ClassModule:
        process = self.process
        body = self.composition.statements(process.body) if process.body is not None else ()
        functions = [self._constructor(), _coroutine("run", body)]
        functions += [_coroutine(method.name, method.body, method.parameter) for method in self.composition.methods]
        bodies = methods(functions, self.imports)
        name, base = self.names.classes[process.name], self.imports.runtime("Process")
        return ClassModule(
            f"The process {process.definition}.",
            self.imports.lines(),
            f"class {name}({base}):",
            docstring(class_doc(process, self.place, "process"), "    "),
            bodies,
        )

    def _parameter(self, name: str) -> Code:
        return own(self.members.arguments[name])

    def _variable(self, name: str) -> Code:
        return self.members.channel(name).field("value")

    def _constructor(self) -> Function:
        source = Constant(quoted(self.place))
        statements: tuple[Statement, ...] = (
            run(call(call("super").field("__init__"), Name("name"), source=source)),
            *self._stored_arguments(),
            *self._reading_ends(),
            *self._channels(),
            *self._instances(),
            *self.composition.alternatives,
        )
        return Function("__init__", self._parameters(), statements)

    def _stored_arguments(self) -> Iterable[Statement]:
        """Parameters and output ports that ``run`` uses."""
        used: dict[str, None] = {}
        for part in parts(self.process.body) if self.process.body is not None else ():
            if isinstance(part, ParameterValue | TunableValue):
                used[part.name] = None
            elif isinstance(part, PortEnd) and not self.members.is_input(part):
                used[part.port] = None
        for name in (item.name for item in (*self.process.parameters, *self.process.ports)):
            if name in used:
                python = self.members.arguments[name]
                yield assign(own(python), Name(python))

    def _reading_ends(self) -> Iterable[Statement]:
        sizes = {port.name: port.size for port in self.process.ports}
        done: set[str] = set()
        for end in self.members.reading_ends:
            name = self.members.end_name(end)
            if name in done:
                continue
            done.add(name)
            if isinstance(end, PortEnd) and sizes[end.port] is not None:
                yield assign(own(name), all_readers(self.members.arguments[end.port], SELF))
            elif isinstance(end, PortEnd):
                yield assign(own(name), Name(self.members.arguments[end.port]).call("reader", SELF))

    def _channels(self) -> Iterable[Statement]:
        yield from self._channels_made(self.process.channels)
        for end in self.members.reading_ends:
            if isinstance(end, ChannelEnd):
                reader = self.members.channel(end.channel).call("reader", SELF)
                yield assign(own(self.members.end_name(end)), reader)

    def _instances(self) -> Iterable[Statement]:
        made: set[str] = set()
        for instance in self.members.with_lists_once(self.process.instances):
            yield from self._made_instance(instance, made)


def all_readers(port: str, owner: Code) -> Code:
    """The reading ends of an array of ports."""
    return Comprehension(Name("end").call("reader", owner), "end", Name(port))


def _coroutine(name: str, body: Statements, parameter: str | None = None) -> Function:
    return Function(name, ("self",) if parameter is None else ("self", parameter), body, waits=True)
