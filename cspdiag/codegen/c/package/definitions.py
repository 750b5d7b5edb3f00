"""`types.h` and `constants.h`: enums, structs, arrays, and the constants of the program."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from cspdiag.codegen.c.text.code import AND, EQUALITY, INDENT, LINE_LENGTH, Atom, Code, Count, call, code, infix
from cspdiag.codegen.c.text.documents import comment, value_remark, wrapped
from cspdiag.codegen.c.text.kernel import KERNEL
from cspdiag.codegen.c.text.names import PackageNames
from cspdiag.codegen.c.text.statements import Block, For, Function, Statement, define, lines, return_value, run, store
from cspdiag.codegen.c.text.types import CTypes
from cspdiag.model.types import ArrayType, StructType, Type
from cspdiag.network.ir.network import Network


def plain_types_header(network: Network, name: str, types: CTypes) -> str:
    """`NAME_types.h`: the types of values, for users of the program; to be generated last."""
    guard = f"{name.upper()}_TYPES_H"
    rows = [
        "/* SPDX-License-Identifier: 0BSD",
        " *",
        " * The types of values: an array is a struct with one member, so it can be assigned.",
        " */",
    ]
    rows += [f"#ifndef {guard}", f"#define {guard}", "", "#include <stdbool.h>", "#include <stdint.h>", ""]
    for enum in network.enums:
        rows += [*_enum(f"enum {types.names.types[enum.name]}", types.names.literals[enum.name]), ""]
    for parameter in network.parameters:
        types.type_name(parameter.type)
    for type_ in _in_order(network, types):
        rows += [*_struct(type_, types), ""]
    rows += _parameters(network, name, types)
    return "\n".join([*rows, "#endif", ""])


def _parameters(network: Network, name: str, types: CTypes) -> list[str]:
    """The structure with the parameters of the program."""
    own = [parameter for parameter in network.parameters if parameter.follows is None]
    if not own:
        return []
    members = [
        define(
            types.type_name(parameter.type),
            types.names.parameters[parameter.name],
            remark=value_remark(parameter.doc or "", parameter.type),
        )
        for parameter in own
    ]
    about = "The parameters of the program, which may change while it runs."
    return [*comment(wrapped(about)), *lines([Block(tuple(members), f"struct {name}_parameters", "};")]), ""]


def types_header(network: Network, names: PackageNames, types: CTypes, plain: str, program: str) -> str:
    """`types.h`, with every type that ``types`` has named so far; to be generated last. ``plain`` is the header with
    the types themselves, and ``program`` the text that may call the functions for them.
    """
    rows = ["/* The types of the program, and how their values are compared and tested. */"]
    rows += ["#ifndef TYPES_H", "#define TYPES_H", "", "#include <stdbool.h>", "#include <stdint.h>", ""]
    rows += [f'#include "{plain}"', ""]
    if network.structs or types.arrays:
        rows += ['#include "csp_arithmetic.h"', ""]
    elif names.exceptions:
        rows += ['#include "csp_core.h"', ""]
    if names.exceptions:
        first, *others = names.exceptions.values()
        entries = [f"{first} = CSP_FIRST_EXCEPTION", *others]
        rows += ["/* The exceptions that the program declares. */", *_enum("enum", entries), ""]
    functions = [found for type_ in _in_order(network, types) for found in _functions(type_, types)]
    needed: list[list[str]] = []
    for name, function in reversed(functions):
        if f"{name}(" in program or any(f"{name}(" in row for other in needed for row in other):
            needed.append(function)
    rows += [row for function in reversed(needed) for row in (*function, "")]
    return "\n".join([*rows, "#endif", ""])


def _enum(head: str, literals: Sequence[str]) -> list[str]:
    line = f"{head} {{ {', '.join(literals)} }};"
    if len(line) <= LINE_LENGTH:
        return [line]
    return [f"{head} {{", *(f"{INDENT}{name}," for name in literals), "};"]


def _in_order(network: Network, types: CTypes) -> Iterator[StructType | ArrayType]:
    """Structs and arrays, each after the types of its fields or elements."""
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
    if isinstance(type_, StructType):
        members = [
            define(types.type_name(field), types.field(member), remark=value_remark("", field))
            for member, field in type_.fields
        ]
    else:
        members = [define(types.type_name(type_.element), f"at[{type_.size}]")]
    return lines([Block(tuple(members), name, "};")])


def _functions(type_: StructType | ArrayType, types: CTypes) -> Iterator[tuple[str, list[str]]]:
    """The names and the lines of the functions for a type."""
    name, suffix = types.type_name(type_), types.suffix(type_)
    compared = (f"{name} left", f"{name} right")
    equal = Function(f"static inline bool {suffix}_equal", compared, tuple(_equality(type_, types)))
    yield f"{suffix}_equal", lines([equal])
    if types.has_reals(type_):
        parameters = (KERNEL, f"{name} value", "const char *port")
        finite = Function(f"static inline void {suffix}_finite", parameters, tuple(_finiteness(type_, types)))
        yield f"{suffix}_finite", lines([finite])


def _equality(type_: StructType | ArrayType, types: CTypes) -> list[Statement]:
    left, right = code("left"), code("right")
    if isinstance(type_, StructType):
        whole: Code | None = None
        for name, field_type in type_.fields:
            part = _equal(field_type, left.field(types.field(name)), right.field(types.field(name)), types)
            whole = part if whole is None else infix("&&", AND, whole, part)
        return [return_value(whole or "true")]
    if type_.size == 1:
        return [return_value(_equal(type_.element, left.field("at").at(0), right.field("at").at(0), types))]
    position = code("position")
    part = _equal(type_.element, left.field("at").at(position), right.field("at").at(position), types)
    body = store("equal", infix("&&", AND, code("equal"), part))
    return [define("bool", "equal", "true"), _each(type_, body), return_value("equal")]


def _each(type_: ArrayType, body: Statement) -> Statement:
    return For(Atom("position"), Atom(str(type_.size)), (body,), type_name="int")


def _equal(type_: Type, left: Code, right: Code, types: CTypes) -> Code:
    if isinstance(type_, StructType | ArrayType):
        return call(f"{types.suffix(type_)}_equal", left, right)
    return infix("==", EQUALITY, left, right)


def _finiteness(type_: StructType | ArrayType, types: CTypes) -> list[Statement]:
    value = code("value")
    if isinstance(type_, StructType):
        checks = (
            types.finite_check(field, value.field(types.field(name)), code("port")) for name, field in type_.fields
        )
        return [run(check) for check in checks if check is not None]
    position = Count(0, "index") if type_.size == 1 else code("position")
    check = types.finite_check(type_.element, value.field("at").at(position), code("port"))
    assert check is not None
    return [run(check) if type_.size == 1 else _each(type_, run(check))]


def constants_header(network: Network, names: PackageNames, types: CTypes) -> str:
    """`constants.h`: the constants of the program."""
    rows = ["/* The constants of the program. */", "#ifndef CONSTANTS_H", "#define CONSTANTS_H", ""]
    rows += ['#include "csp_arithmetic.h"', '#include "types.h"', ""]
    for constant in network.constants:
        if constant.doc:
            rows += comment(wrapped(constant.doc))
        place = names.place(constant.span.file, constant.span.line)
        type_name, value = (
            f"static const {types.type_name(constant.type)}",
            types.initial(constant.value, constant.type),
        )
        rows += lines([define(type_name, names.constants[constant.name], value, place)])
    return "\n".join([*rows, *([""] if network.constants else []), "#endif", ""])
