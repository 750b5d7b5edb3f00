"""Compile-time checks of hand-written headers of control laws: members and functions must have the types of the text.

Values are copied bytewise between ports and members, so a member of another type would silently hold a wrong value;
and C converts an argument to whatever the parameter is.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from cspdiag.base.record import record
from cspdiag.codegen.c.interface.layout import Layout
from cspdiag.codegen.c.laws.calls import body_name, law_members
from cspdiag.codegen.c.laws.external import header_of
from cspdiag.codegen.c.text.code import call, unsigned
from cspdiag.codegen.c.text.documents import comment
from cspdiag.codegen.c.text.literals import quoted
from cspdiag.codegen.c.text.names import PackageNames, snake_case
from cspdiag.codegen.c.text.statements import lines, run
from cspdiag.codegen.c.text.types import CTypes
from cspdiag.codegen.shared.target_error import TargetError
from cspdiag.model.types import TextType, Type
from cspdiag.network.ir.equations import ExternalBody
from cspdiag.network.ir.external import external_calls
from cspdiag.network.ir.network import Environment, Network, SubmodelClass

FILE = "types_by_hand.c"


@record
class _Member:
    """A member that a hand-written struct must have; ``where`` is the place of the port in the source text."""

    body: ExternalBody
    struct: str
    name: str
    type: Type
    port: str
    where: str


@record
class _Initialization:
    """The types of the arguments that initialize a hand-written law."""

    body: ExternalBody
    struct: str
    arguments: tuple[str, ...]


def checks_file(network: Network, names: PackageNames, types: CTypes) -> dict[str, str]:
    """A file that does not compile if a hand-written header has members or parameters of other types than the text; no
    file if the network has no such headers.
    """
    members = list(dict.fromkeys(_members(network, names, types)))
    functions = list(dict.fromkeys(_functions(network, names, types)))
    if not functions:
        return {}
    headers = sorted({f"{item.struct}.h" for item in functions})
    rows = comment(["Does not compile where a header that is written by hand has other types than the program."])
    rows += ['#include "types.h"', *(f'#include "{header}"' for header in headers), '#include "csp_by_hand.h"', ""]
    for item in members:
        rows += required_member(header_of(item.body), item.struct, item.name, types.type_name(item.type), item.where)
    for law in functions:
        span, header, itself = law.body.span, header_of(law.body), f"struct {law.struct} *"
        where = names.place(span.file, span.line)
        rows += required_function(header, "void", f"{law.struct}_initialize", (itself, *law.arguments), where)
        rows += required_function(header, "void", f"{law.struct}_calculate", (itself,), where)
    return {FILE: "\n".join([*rows, ""])}


def refuse_missing_members(
    network: Network,
    environments: Iterable[Environment],
    headers: Layout,
    names: PackageNames,
    types: CTypes,
) -> None:
    """Raises TargetError if a struct in one of the ``headers`` lacks the member of a port of a law of the network or of
    a driver of the ``environments``. Other wrong members are found when the package is compiled.
    """
    found: list[_Member] = [*_members(network, names, types)]
    for environment in environments:
        found += _of_drivers(network, environment, names, types)
    reasons = [
        f"{header_of(item.body)}: `struct {item.struct}` has no member `{item.name}` for the port `{item.port}` "
        f"({item.where})"
        for item in dict.fromkeys(found)
        if headers.lacks(f"struct {item.struct}", item.name)
    ]
    if reasons:
        raise TargetError("\n".join(reasons))


def _of_drivers(network: Network, environment: Environment, names: PackageNames, types: CTypes) -> Iterator[_Member]:
    ports = {port.key: port for port in network.external_ports}
    for driver in environment.drivers:
        if driver.external.language != "c":
            continue
        where = names.place(driver.external.span.file, driver.external.span.line)
        for connected, key in driver.connections:
            port = connected.partition("[")[0]
            if key in ports:
                struct = snake_case(driver.definition)
                yield _Member(driver.external, struct, types.field(port), ports[key].type, port, where)


def required_member(
    header: str, struct: str, member: str, expected: str, where: str, size: int | None = None
) -> list[str]:
    """The lines that do not compile if a member of a struct in a hand-written ``header`` has another type than its
    port, which is declared at ``where``; with ``size``, that of the elements of an array of that length.
    """
    shown = expected if size is None else f"{expected}[{size}]"
    message = f"{header}: the member `{member}` of `struct {struct}` has to be `{shown}`, as the port is ({where})"
    number = () if size is None else (unsigned(size),)
    macro = "CSP_REQUIRE_MEMBER" if size is None else "CSP_REQUIRE_ARRAY"
    name = f"{struct}_{member}_must_be_as_its_port"
    return lines([run(call(macro, f"struct {struct}", member, expected, *number, name, quoted(message)))])


def required_function(header: str, result: str, function: str, parameters: Sequence[str], where: str) -> list[str]:
    """The lines that do not compile if a function in a hand-written ``header`` takes or returns other types than the
    definition at ``where`` says.
    """
    listed = ", ".join(parameters)
    message = f"{header}: `{function}` has to be `{result} {function}({listed})`, as its definition is ({where})"
    name = f"{function}_must_be_as_its_definition"
    return lines([run(call("CSP_REQUIRE_FUNCTION", result, function, f"({listed})", name, quoted(message)))])


def type_of_argument(type_: Type, types: CTypes) -> str:
    """The C type of an argument of a hand-written function."""
    return "const char *" if isinstance(type_, TextType) else types.type_name(type_)


def _functions(network: Network, names: PackageNames, types: CTypes) -> Iterator[_Initialization]:
    for class_ in network.classes:
        if not isinstance(class_, SubmodelClass):
            continue
        if class_.external is not None and class_.external.language == "c":
            kinds = (
                f"const {types.type_name(item.type)} *" if item.tunable else type_of_argument(item.type, types)
                for item in class_.parameters
            )
            yield _Initialization(class_.external, names.classes[class_.name], tuple(kinds))
        yield from _initialized_in(class_, types)
    for environment in network.environments:
        yield from _initialized_in(environment, types)


def _initialized_in(owner: SubmodelClass | Environment, types: CTypes) -> Iterator[_Initialization]:
    for called in external_calls(owner):
        if called.external.language == "c":
            kinds = tuple([type_of_argument(value.type, types) for _, value in called.arguments])
            yield _Initialization(called.external, body_name(called), kinds)


def _members(network: Network, names: PackageNames, types: CTypes) -> Iterator[_Member]:
    for class_ in network.classes:
        if isinstance(class_, SubmodelClass):
            if class_.external is not None and class_.external.language == "c":
                yield from _of_class(class_, class_.external, names)
            yield from _of_calls(class_, names, types)
    for environment in network.environments:
        yield from _of_calls(environment, names, types)


def _of_class(class_: SubmodelClass, body: ExternalBody, names: PackageNames) -> Iterator[_Member]:
    members = law_members(class_, names)
    for port in class_.ports:
        if port.size is not None:
            continue
        where = names.place(port.span.file, port.span.line)
        yield _Member(body, names.classes[class_.name], members[port.name], port.type, port.name, where)


def _of_calls(owner: SubmodelClass | Environment, names: PackageNames, types: CTypes) -> Iterator[_Member]:
    for called in external_calls(owner):
        if called.external.language != "c":
            continue
        where = names.place(called.span.file, called.span.line)
        ports = [
            *((port, value.type) for port, value in called.inputs),
            *((port, type_) for port, _, type_ in called.outputs),
        ]
        for port, type_ in ports:
            yield _Member(called.external, body_name(called), types.field(port), type_, port, where)
