"""Named constants, enums, structs and exceptions of the text."""

from __future__ import annotations

from cspdiag.base.record import record
from cspdiag.codegen.python.text.imports import Imports
from cspdiag.codegen.python.text.literals import remark
from cspdiag.codegen.python.text.names import PackageNames
from cspdiag.codegen.python.text.statements import assign, lines
from cspdiag.codegen.python.text.types import annotation, enum_members, field_names, literal
from cspdiag.network.ir.network import Network


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
