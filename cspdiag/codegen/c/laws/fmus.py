"""Submodels that are FMUs: a struct with the ports, and tables for ``csp_fmu.c``, which loads the binary."""

from __future__ import annotations

import os
import pathlib
import posixpath
from collections.abc import Iterator, Sequence

from cspdiag.base.files.resources import template_folder
from cspdiag.codegen.c.laws.calls import body_name
from cspdiag.codegen.c.text.documents import comment
from cspdiag.codegen.c.text.literals import quoted
from cspdiag.codegen.c.text.types import CTypes
from cspdiag.codegen.shared.target_error import TargetError
from cspdiag.fmu.description import FmuDescription, FmuError, read_description
from cspdiag.fmu.extracted import binary, extracted
from cspdiag.model.types import BoolType, IntType, RealType, Type
from cspdiag.network.ir.equations import ExternalCall
from cspdiag.network.ir.external import file_of_fmu, fmu_calls
from cspdiag.network.ir.network import Environment

_LOADER = (
    "csp_fmu.c", "csp_fmu.h", "csp_fmu_integration.c", "csp_fmu_library.c", "csp_fmu_library.h", "csp_fmu_values.c",
)  # fmt: skip


def fmu_files(environment: Environment, types: CTypes) -> dict[str, str]:
    """A header and a source for each submodel that is an FMU, and what loads them.

    Unpacks the FMUs into the cache. Raises TargetError for one that cannot run on this machine.
    """
    calls = {item.definition: item for item in fmu_calls(environment)}
    if not calls:
        return {}
    folder = template_folder("c") / "fmu"
    files = {name: (folder / name).read_text(encoding="utf-8") for name in _LOADER}
    for item in calls.values():
        name = body_name(item)
        files[f"{name}.h"] = _header(item, name, types)
        try:
            files[f"{name}.c"] = _source(item, name, types)
        except FmuError as problem:
            raise TargetError(f"{item.external.span}: {problem.message}\n  help: {problem.advice}") from None
    return files


def _members(item: ExternalCall) -> Iterator[tuple[str, Type]]:
    yield from ((name, value.type) for name, value in item.arguments)
    yield from ((port, value.type) for port, value in item.inputs)
    yield from ((port, type_) for port, _, type_ in item.outputs)


def _header(item: ExternalCall, name: str, types: CTypes) -> str:
    guard = f"{name.upper()}_H"
    parameters = "".join(f", {types.type_name(value.type)} {types.field(key)}" for key, value in item.arguments)
    rows = [
        *comment([f"{item.definition}, the FMU {posixpath.basename(item.external.target.partition(':')[0])}."]),
        f"#ifndef {guard}",
        f"#define {guard}",
        "",
        '#include "csp_fmu.h"',
        "",
        f"struct {name} {{",
        *(f"    {types.type_name(type_)} {types.field(key)};" for key, type_ in _members(item)),
        "    csp_fmu instance;",
        "};",
        "",
        f"void {name}_initialize(struct {name} *self{parameters});",
        f"void {name}_calculate(csp_kernel *csp, struct {name} *self, double time);",
        "",
        "#endif",
        "",
    ]
    return "\n".join(rows)


def library_of(item: ExternalCall) -> str:
    """The path of the binary of an FMU, which is unpacked into the cache. Raises FmuError."""
    path = file_of_fmu(item.external)
    return _library(item, path, read_description(path))


def _library(item: ExternalCall, path: str, description: FmuDescription) -> str:
    identifier = description.model_exchange if _is_model_exchange(item, description) else description.co_simulation
    if identifier is None:
        raise FmuError(f"{path} is not made for {_interface(item) or 'simulation'}", "export it for co-simulation")
    library = binary(path, description, identifier)
    return os.path.join(extracted(path), library)


def _interface(item: ExternalCall) -> str:
    """The interface that the text chooses; empty if it leaves that to the FMU."""
    return item.external.target.partition(":")[2]


def _is_model_exchange(item: ExternalCall, description: FmuDescription) -> bool:
    return (_interface(item) or ("" if description.co_simulation else "ModelExchange")) == "ModelExchange"


def _source(item: ExternalCall, name: str, types: CTypes) -> str:
    path = file_of_fmu(item.external)
    description = read_description(path)
    library, folder = _library(item, path, description), extracted(path)
    is_new = description.version == "3.0"
    resources = os.path.join(folder, "resources")
    place = resources + os.sep if is_new else pathlib.Path(resources).as_uri()
    parameters = [(key, value.type) for key, value in item.arguments]
    inputs = [(port, value.type) for port, value in item.inputs]
    outputs = [(port, type_) for port, _, type_ in item.outputs]
    tables = {"parameters": parameters, "inputs": inputs, "outputs": outputs}
    rows = [f"/* See {name}.h. */", f'#include "{name}.h"', ""]
    for word, ports in tables.items():
        rows += _table(word, ports, name, description, types)
    facts = {
        "name": quoted(path),
        "library": quoted(library),
        "resources": quoted(place),
        "instance": quoted(description.name),
        "token": quoted(description.token),
        "is_new": str(is_new).lower(),
        "is_model_exchange": str(_is_model_exchange(item, description)).lower(),
        "states": f"{description.states}U",
        "indicators": f"{description.indicators}U",
        "step": f"INT64_C({item.external.step or 0})",
        "is_euler": str(item.external.method == "euler").lower(),
    }
    for word, ports in tables.items():
        singular = word.removesuffix("s")
        facts[word] = word if ports else "NULL"
        facts[f"{singular}_count"] = f"{len(ports)}U"
    rows += [
        "static const csp_fmu_facts facts = {",
        *(f"    .{key} = {value}," for key, value in facts.items()),
        "};",
        "",
    ]
    given = "".join(f", {types.type_name(type_)} {types.field(key)}" for key, type_ in parameters)
    rows += [f"void {name}_initialize(struct {name} *self{given})", "{"]
    rows += [f"    self->{types.field(key)} = {types.field(key)};" for key, _ in parameters]
    rows += ["    csp_fmu_initialize(&self->instance, &facts);", "}", ""]
    rows += [f"void {name}_calculate(csp_kernel *csp, struct {name} *self, double time)", "{"]
    rows += ["    csp_fmu_calculate(csp, &self->instance, self, time);", "}", ""]
    return "\n".join(rows)


def _table(
    word: str, ports: Sequence[tuple[str, Type]], name: str, description: FmuDescription, types: CTypes
) -> list[str]:
    if not ports:
        return []
    rows = [f"static const csp_fmu_port {word}[] = {{"]
    for port, type_ in ports:
        variable = description.named(port)
        if variable is None:
            raise FmuError(f"{description.name} has no variable {port}", "name a variable of the FMU")
        is_new = description.version == "3.0"
        functions = variable.type if variable.type != "Enumeration" else ("Int64" if is_new else "Integer")
        is_discrete = str(variable.variability != "continuous").lower()
        rows.append(
            f"    {{{variable.reference}U, {quoted(functions)}, {_fmu_type(functions, is_new)}, {_member(type_)}, "
            f"offsetof(struct {name}, {types.field(port)}), {is_discrete}, {str(variable.lacks_zero).lower()}}},"
        )
    return [*rows, "};", ""]


def _fmu_type(functions: str, is_new: bool) -> str:
    named = {"Real": "FLOAT64", "Integer": "INT32", "Boolean": "BOOL" if is_new else "BOOLEAN"}
    return f"CSP_FMU_{named.get(functions, functions.upper())}"


def _member(type_: Type) -> str:
    match type_:
        case RealType():
            return f"CSP_FMU_FLOAT{type_.bits}"
        case IntType():
            return f"CSP_FMU_{'' if type_.signed else 'U'}INT{type_.bits}"
        case BoolType():
            return "CSP_FMU_BOOL"
        case _:  # The check of FMUs has refused other types.
            raise FmuError(f"a {type_} is no type of FMI", "give it another type")
