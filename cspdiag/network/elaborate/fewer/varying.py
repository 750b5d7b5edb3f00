"""What of a program varies with the sizes of its arrays, and whether only counts, indexes and values do."""

from __future__ import annotations

from collections.abc import Iterable, Set
from itertools import chain

from cspdiag.base.record import node
from cspdiag.model.program import PortSymbol, Program
from cspdiag.network.elaborate.definitions import Definitions, arguments_of
from cspdiag.network.elaborate.fewer.sizes import counts_in
from cspdiag.syntax import ast
from cspdiag.syntax.walk import declared_in, names, nodes


@node
class Varying:
    """What varies with the sizes of the arrays of a program."""

    symbols: frozenset[ast.Node]
    """Constants, replicators and parameters."""
    definitions: tuple[ast.ProcessDefinition, ...]
    """The processes whose text has such symbols, or whose instances have arrays of ports whose sizes vary; callees
    first.
    """

    def is_in(self, program: Program, parts: Iterable[ast.Node]) -> bool:
        """Whether any of the parts varies."""
        return _varies(program, self.symbols, parts)


def varying(program: Program, few: Program) -> Varying | None:
    """What varies between a program and the same with fewer elements.

    None if anything does that is not a count, an index of instances or ports, or a value that is only communicated or
    assigned, and wherever the elements of an array may not be judged by their neighbourhoods: control laws, samples,
    environments.
    """
    if not _is_plain(program) or program.constants.keys() != few.constants.keys():
        return None
    symbols: set[ast.Node] = {
        constant for constant, value in program.constants.items() if few.constants[constant] != value
    }
    definitions = Definitions(program)
    processes = definitions.order
    if definitions.recursive or not _add_parameters(program, definitions, symbols):
        return None
    for part in nodes(*processes):
        if isinstance(part, ast.Replicator) and _varies(program, symbols, (part.count,)):
            symbols.add(part)
    # Arguments may depend on the replicators that were found only now.
    if not _add_parameters(program, definitions, symbols):
        return None
    texts = [one for one in program.definitions.values() if not isinstance(one, ast.Constant)]
    if any(isinstance(part, ast.Replicated) and _is_in_order(part, symbols) for part in nodes(*texts)):
        return None
    allowed = {name for part in nodes(*processes) for name in names(_where_allowed(program, part))}
    if any(program.bindings.get(one) in symbols and one not in allowed for one in names((*texts, *program.assertions))):
        return None
    found: list[ast.ProcessDefinition] = []
    with_ports: set[ast.ProcessDefinition] = set()
    for definition in processes:
        ports = [port for declared in definition.ports for port in declared.names]
        inner = [definitions.instantiated(item) for item in declared_in(definition) if isinstance(item, ast.Instance)]
        if any(_varies(program, symbols, port.dimensions) for port in ports):
            with_ports.add(definition)
        if _varies(program, symbols, (definition,)) or any(one in with_ports for one in inner):
            if definitions.structural(definition):
                return None
            found.append(definition)
    return Varying(symbols=frozenset(symbols), definitions=tuple(found))


def _is_plain(program: Program) -> bool:
    """Whether there are only processes, without samples."""
    for definition in program.definitions.values():
        if isinstance(definition, ast.SubmodelDefinition | ast.EnvironmentDefinition | ast.DriverDefinition):
            return False
        if isinstance(definition, ast.ProcessDefinition) and any(
            ports.sampling is not None for ports in definition.ports
        ):
            return False
    return True


def _varies(program: Program, symbols: Set[ast.Node], parts: Iterable[ast.Node]) -> bool:
    return any(program.bindings.get(name) in symbols for name in names(parts))


def _add_parameters(program: Program, definitions: Definitions, symbols: set[ast.Node]) -> bool:
    """Adds the parameters to which arguments that vary are given; False if a structure depends on one."""
    for definition in definitions.processes:
        for item in declared_in(definition):
            callee = definitions.instantiated(item) if isinstance(item, ast.Instance) else None
            if not isinstance(item, ast.Instance) or callee is None:
                continue
            for parameter, argument in arguments_of(callee.parameters, item.arguments):
                if _varies(program, symbols, (argument,)):
                    if parameter.name.text in definitions.structural(callee):
                        return False
                    symbols.add(parameter)
    return True


def _is_in_order(part: ast.Replicated, symbols: set[ast.Node]) -> bool:
    """Whether parts whose number varies follow, or take precedence over one another."""
    return part.operator in ("seq", "prialt") and part.replicator in symbols


def _where_allowed(program: Program, part: ast.Node) -> Iterable[ast.Expression]:
    """The expressions of a node that may vary."""
    match part:
        case ast.Instance(arguments=arguments):
            return chain(counts_in(part), (argument.value for argument in arguments))
        case ast.Reference(indexes=indexes, member_indexes=inner):
            chooses = isinstance(program.bindings.get(part), ast.Instance | PortSymbol)
            return (*indexes, *inner) if chooses else ()
        case ast.Write(value=value) | ast.Assign(value=value) | ast.OutputGuard(value=value):
            # An index may choose an element of another value, and so what is read.
            return () if any(isinstance(inner, ast.Index) for inner in nodes(value)) else (value,)
        case _:  # Of other nodes, only counts may vary.
            return counts_in(part)
