"""Named constants, parameters, enums, structs and exceptions of the text."""

from __future__ import annotations

from cspdiag.base.record import record
from cspdiag.codegen.python.plain.expressions import Printer
from cspdiag.codegen.python.text.code import SELF, Argument, Call, Constant, call, own, typed
from cspdiag.codegen.python.text.imports import Imports
from cspdiag.codegen.python.text.literals import quoted, remark
from cspdiag.codegen.python.text.names import PackageNames
from cspdiag.codegen.python.text.splitting import methods
from cspdiag.codegen.python.text.statements import Function, Remark, Statement, assign, lines, run
from cspdiag.codegen.python.text.types import accepted, annotation, enum_members, field_names, literal
from cspdiag.network.ir.network import Network, ProgramParameter


@record
class Definition:
    """A class with the rows of its body."""

    name: str
    doc: str
    rows: list[str]


def constant_lines(network: Network, names: PackageNames) -> tuple[list[str], list[str]]:
    """Imports and assignments of the constants, each after its doc comment."""
    imports = Imports(names)
    rows: list[str] = []
    for constant in network.constants:
        value = literal(constant.value, constant.type, imports)
        place = names.place(constant.span.file, constant.span.line)
        if constant.doc:
            rows += [""] if rows else []
            rows += [f"# {remark(row)}".rstrip() for row in constant.doc.strip().split("\n")]
        rows += lines([assign(names.constants[constant.name], value, place)], "")
    return imports.lines(), rows


def enum_views(network: Network, names: PackageNames) -> list[Definition]:
    """Enums, with their literals as members."""
    return [
        Definition(
            names.types[enum.name],
            f"The enum {enum.name}.",
            [f"{member} = {index}" for index, member in enumerate(enum_members(enum).values())],
        )
        for enum in network.enums
    ]


def struct_views(network: Network, names: PackageNames) -> tuple[list[str], list[Definition]]:
    """Imports, and structs with their fields."""
    imports = _OwnTypes(names)
    imports_enum = [imports.standard("enum", "IntEnum")] if network.enums else []
    views = [
        Definition(
            names.types[struct.name],
            f"The struct {struct.name}.",
            [f"{field_names(struct)[name]}: {annotation(type_, imports)}" for name, type_ in struct.fields],
        )
        for struct in network.structs
    ]
    if network.structs:
        imports_enum.append(imports.standard("typing", "NamedTuple"))
    return imports.lines(), views


class _OwnTypes(Imports):
    """The imports of ``types.py``, where types need no import."""

    def type_(self, name: str) -> str:
        return self.names.types[name]


def exception_views(names: PackageNames) -> list[Definition]:
    """Declared exceptions."""
    return [Definition(python, f"The exception {name}.", []) for name, python in names.exceptions.items()]


@record
class ParametersModule:
    """The values for its template."""

    imports: list[str]
    head: str
    functions: list[list[str]]


def parameters_module(network: Network, names: PackageNames) -> ParametersModule:
    """The module ``parameters``."""
    imports = Imports(names)
    head = f"class Parameters({imports.runtime('ProgramParameters')}):"
    statements: list[Statement] = [run(call(call("super").field("__init__")))]
    followed: list[Statement] = []
    printer = Printer(imports, program=SELF)
    for parameter in network.parameters:
        statements += [Remark(row) for row in (parameter.doc or "").strip().split("\n") if row]
        place = names.place(parameter.span.file, parameter.span.line)
        statements.append(assign(own(names.parameters[parameter.name]), _made(parameter, imports), place))
        if parameter.follows is not None:
            target = own(names.parameters[parameter.name]).field("value")
            followed.append(assign(target, printer.print(parameter.follows), place))
    functions = [Function("__init__", ("self",), tuple(statements))]
    if followed:
        doc = "Compute the constants that follow from the parameters."
        functions.append(Function("follow", ("self",), tuple(followed), doc=doc))
    return ParametersModule(imports=imports.lines(), head=head, functions=methods(functions, imports))


def _made(parameter: ProgramParameter, imports: Imports) -> Call:
    arguments = [
        Argument(Constant(quoted(parameter.name))),
        Argument(literal(parameter.value, parameter.type, imports)),
    ]
    if parameter.follows is None:
        arguments.append(Argument(accepted(parameter.type, imports)))
    made = typed(imports.runtime("Parameter"), annotation(parameter.type, imports))
    return Call(made, tuple(arguments))
