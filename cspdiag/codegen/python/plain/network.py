"""The module that builds the network: the only one that knows the drivers."""

from __future__ import annotations

from collections.abc import Iterable

from cspdiag.base.record import record
from cspdiag.codegen.python.plain.external import ExternalModules, converting
from cspdiag.codegen.python.plain.instances import keywords_of
from cspdiag.codegen.python.text.code import (
    OR,
    TRUE,
    Argument,
    Call,
    Code,
    Constant,
    Items,
    Name,
    call,
    tuple_of,
    typed,
)
from cspdiag.codegen.python.text.imports import Imports
from cspdiag.codegen.python.text.literals import quoted
from cspdiag.codegen.python.text.names import Names, PackageNames
from cspdiag.codegen.python.text.operators import infix
from cspdiag.codegen.python.text.statements import Assign, Statement, assign, lines, return_
from cspdiag.codegen.python.text.types import accepted, annotation, duration, literal
from cspdiag.network.ir.network import ExternalPort, Network, ProcessClass


@record
class NetworkModule:
    """The values for its template."""

    imports: list[str]
    port_names: list[str]
    drivers: str
    parameters: str
    body: list[str]


def network_view(network: Network, names: PackageNames, modules: ExternalModules) -> NetworkModule:
    """The module ``network``."""
    top = network.class_named(network.top)
    local = Names({"drivers", "parameters"} if network.parameters else {"drivers"})
    by_port = {port.key: local[port.key] for port in network.external_ports}
    imports = Imports(names, taken=[*by_port.values(), "drivers", "parameters"])
    statements: list[Statement] = [
        assign(by_port[port.key], _port(port, network, imports)) for port in network.external_ports
    ]
    if network.parameters:
        given = Name("parameters")
        statements.insert(0, assign("parameters", infix("or", OR, given, call(imports.parameters()))))
    by_hand = top.external if isinstance(top, ProcessClass) else None
    keywords = keywords_of(top)
    arguments = [Argument(Constant(quoted(network.top)))]
    types = {parameter.name: parameter.type for parameter in top.parameters}
    arguments += [Argument(literal(value, types[name], imports), keywords[name]) for name, value in network.arguments]
    arguments += [
        Argument(Name("parameters").field(names.parameters[parameter]), keywords[name])
        for name, parameter in network.tunable
    ]
    for port in top.ports:
        own = [Name(by_port[e.key]) for e in network.external_ports if _belongs(e, port.name)]
        value: Code = own[0] if port.size is None else Items("[]", tuple(own))
        if by_hand is not None:
            value = converting(port, value, imports)
        arguments.append(Argument(value, keywords[port.name]))
    class_ = modules.imported(by_hand, imports) if by_hand is not None else imports.class_(network.top)
    made = Call(Name(class_), tuple(arguments))
    ends = tuple_of(Name(name) for name in by_port.values())
    parts = [Argument(made), *([Argument(ends, "ports")] if by_port else ())]
    parts += [Argument(Name("parameters"), "parameters")] if network.parameters else []
    built = Call(Name(imports.runtime("Network")), tuple(parts))
    statements.append(return_(built))
    keys = tuple_of(Constant(quoted(key)) for key in by_port)
    mapping, driver = imports.standard("collections.abc", "Mapping"), imports.runtime("Driver")
    return NetworkModule(
        imports.lines(),
        lines([Assign(Name("PORTS"), keys, annotation="tuple[str, ...]")]),
        f"{mapping}[str, {driver}]",
        f", parameters: {imports.parameters()} | None = None" if network.parameters else "",
        lines(statements, "    "),
    )


def _belongs(external: ExternalPort, port: str) -> bool:
    return external.name == port or external.name.startswith(f"{port}[")


def _port(port: ExternalPort, network: Network, imports: Imports) -> Code:
    sampled = port.sampling is not None
    class_ = ("Sampled" if sampled else "Event") + ("Input" if port.direction == "in" else "Output")
    arguments = [Argument(Constant(quoted(f"{network.top}.{port.key}"))), *_options(port, imports)]
    return Call(typed(imports.runtime(class_), annotation(port.type, imports)), tuple(arguments))


def _options(port: ExternalPort, imports: Imports) -> Iterable[Argument]:
    if port.sampling is not None:
        yield Argument(duration(port.sampling.period, imports), "period")
        if port.sampling.offset:
            yield Argument(duration(port.sampling.offset, imports), "offset")
    yield Argument(Name("drivers").at(Constant(quoted(port.key))), "driver")
    if port.direction == "out":
        if port.safe is not None:
            yield Argument(literal(port.safe, port.type, imports), "safe")
        if port.immediate:
            yield Argument(TRUE, "immediate")
        return
    if port.sampling is None and port.kind != "sync":
        yield Argument(Constant(quoted(port.kind)), "kind")
    yield Argument(accepted(port.type, imports), "accepts")
