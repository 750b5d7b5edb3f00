"""`types.h` and `constants.h`: enums, structs, arrays, and the constants of the text."""

from __future__ import annotations

from collections.abc import Iterator

from cspdiag.codegen.c.text.code import INDENT, LINE_LENGTH, broken, statement
from cspdiag.codegen.c.text.documents import comment, wrapped
from cspdiag.codegen.c.text.names import PackageNames
from cspdiag.codegen.c.text.types import CTypes, scalars
from cspdiag.model.types import ArrayType, EnumType, RealType, StructType, Type
from cspdiag.network.ir.network import Network

_COMPARED = " && "


def types_header(network: Network, names: PackageNames, types: CTypes) -> str:
    """`types.h`, with every type that ``types`` has named; generated last, when all are known."""
    rows = ["/* The types of the program. Every value can be assigned: an array is a struct with one member. */"]
    rows += ["#ifndef TYPES_H", "#define TYPES_H", "", "#include <stdbool.h>", "#include <stdint.h>", ""]
    if network.structs or types.arrays:
        rows += ['#include "csp_arithmetic.h"', ""]
    elif names.exceptions:
        rows += ['#include "csp_core.h"', ""]
    if names.exceptions:
        first, *others = names.exceptions.values()
        entries = ", ".join([f"{first} = CSP_FIRST_EXCEPTION", *others])
        rows += ["/* The exceptions that the program declares. */", *broken(f"enum {{ {entries} }};", INDENT), ""]
    for enum in network.enums:
        rows += [*_enum(enum, names), ""]
    for type_ in _in_order(network, types):
        rows += [*_struct(type_, types), ""]
    return "\n".join([*rows, "#endif", ""])


def _enum(enum: EnumType, names: PackageNames) -> list[str]:
    literals = names.literals[enum.name]
    line = f"enum {names.types[enum.name]} {{ {', '.join(literals)} }};"
    if len(line) <= LINE_LENGTH:
        return [line]
    return [f"enum {names.types[enum.name]} {{", *(f"{INDENT}{name}," for name in literals), "};"]


def _in_order(network: Network, types: CTypes) -> Iterator[StructType | ArrayType]:
    """Structs and arrays, each after those that it is made of."""
    done: set[str] = set()

    def visit(type_: Type) -> Iterator[StructType | ArrayType]:
        if not isinstance(type_, StructType | ArrayType) or types.type_name(type_) in done:
            return
        for inner in [field for _, field in type_.fields] if isinstance(type_, StructType) else [type_.element]:
            yield from visit(inner)
        done.add(types.type_name(type_))
        yield type_

    for struct in network.structs:
        yield from visit(struct)
    for array in types.arrays:
        yield from visit(array)


def _struct(type_: StructType | ArrayType, types: CTypes) -> list[str]:
    name = types.type_name(type_)
    rows = [f"{name} {{"]
    if isinstance(type_, StructType):
        rows += [f"{INDENT}{types.type_name(field)} {types.field(member)};" for member, field in type_.fields]
    else:
        rows += [f"{INDENT}{types.type_name(type_.element)} at[{type_.size}];"]
    rows += ["};", ""]
    rows += [f"static inline bool {types.suffix(type_)}_equal({name} left, {name} right)", "{"]
    rows += [*_equality(type_, types), "}"]
    if types.has_reals(type_):
        rows += ["", f"static inline void {types.suffix(type_)}_finite({name} value, const char *port)", "{"]
        rows += [*_finiteness(type_, types), "}"]
    return rows


def _equality(type_: StructType | ArrayType, types: CTypes) -> list[str]:
    if isinstance(type_, StructType):
        parts = [_equal(field, f".{types.field(name)}", types) for name, field in type_.fields]
        return statement("return ", _COMPARED.join(parts) or "true", ";", INDENT)
    part = _equal(type_.element, ".at[position]", types)
    return [
        f"{INDENT}bool equal = true;",
        f"{INDENT}for (int position = 0; position < {type_.size}; position++) {{",
        f"{INDENT * 2}equal = equal && {part};",
        f"{INDENT}}}",
        f"{INDENT}return equal;",
    ]


def _equal(type_: Type, member: str, types: CTypes) -> str:
    if isinstance(type_, StructType | ArrayType):
        return f"{types.suffix(type_)}_equal(left{member}, right{member})"
    return f"(left{member} == right{member})"


def _finiteness(type_: StructType | ArrayType, types: CTypes) -> list[str]:
    if isinstance(type_, StructType):
        checks = (finite_check(types, field, f"value.{types.field(name)}", "port") for name, field in type_.fields)
        return [f"{INDENT}{check}" for check in checks if check is not None]
    check = finite_check(types, type_.element, "value.at[position]", "port")
    return [
        f"{INDENT}for (int position = 0; position < {type_.size}; position++) {{",
        f"{INDENT * 2}{check}",
        f"{INDENT}}}",
    ]


def finite_check(types: CTypes, type_: Type, value: str, port: str) -> str | None:
    """The statement that notes a fault if a value that is written to an external output is not finite; None if it always is.

    ``port`` is a C expression: the name of the port as a string.
    """
    if not any(isinstance(part, RealType) for part in scalars(type_)):
        return None
    if isinstance(type_, StructType | ArrayType):
        return f"{types.suffix(type_)}_finite({value}, {port});"
    return (
        f"csp_finite({'(double)' if type_.bits == 32 else ''}{value}, {port});" if isinstance(type_, RealType) else None
    )


def constants_header(network: Network, names: PackageNames, types: CTypes) -> str:
    """`constants.h`: the constants of the text."""
    rows = ["/* The constants of the program. */", "#ifndef CONSTANTS_H", "#define CONSTANTS_H", ""]
    rows += ['#include "csp_arithmetic.h"', '#include "types.h"', ""]
    for constant in network.constants:
        if constant.doc:
            rows += comment(wrapped(constant.doc))
        place = names.place(constant.span.file, constant.span.line)
        head = f"static const {types.type_name(constant.type)} {names.constants[constant.name]} = "
        rows += statement(head, types.initializer(constant.value, constant.type), ";", "", place)
    return "\n".join([*rows, *([""] if network.constants else []), "#endif", ""])
