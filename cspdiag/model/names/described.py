"""Submodels whose ports are not in the text but in the description of their FMU."""

from __future__ import annotations

import math
import posixpath
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, TypeGuard

from cspdiag.base import Report, SourceFile
from cspdiag.base.record import replaced
from cspdiag.syntax import ast

if TYPE_CHECKING:
    from cspdiag.fmu.description import FmuDescription, FmuUnit, FmuVariable
    from cspdiag.model.units import Unit

LANGUAGE = "fmu"
_INTERFACES = (":CoSimulation", ":ModelExchange")
_TYPES = {
    "Real": "double", "Float64": "double", "Float32": "float", "Boolean": "bool",
    "Integer": "int", "Int64": "int", "Enumeration": "int",
    "Int8": "int8", "Int16": "int16", "Int32": "int32", "UInt8": "uint8", "UInt16": "uint16", "UInt32": "uint32",
}  # fmt: skip
"""The types of the language for those of FMI; others have none."""


def fmu_path(external: ast.External) -> str:
    """The path of an FMU, relative like that of the file that names it."""
    target = external.target
    for interface in _INTERFACES:
        target = target.removesuffix(interface)
    return posixpath.normpath(posixpath.join(posixpath.dirname(external.target_span.file), target))


def names_fmu(tree: ast.SourceTree) -> bool:
    """Whether a file has a submodel that is an FMU, so that what is found in it depends on more than its text."""
    return any(map(_is_fmu, tree.items))


def with_described_ports(trees: Sequence[ast.SourceTree]) -> list[ast.SourceTree]:
    """The trees, in which submodels that are FMUs and declare no ports have those of the FMU. One that cannot be read
    is left as it is; it is reported when bodies are checked.
    """
    return [_with_ports(tree) if any(map(_lacks_ports, tree.items)) else tree for tree in trees]


def _is_fmu(item: ast.Node) -> TypeGuard[ast.SubmodelDefinition]:
    return (
        isinstance(item, ast.SubmodelDefinition)
        and item.external is not None
        and item.external.language.text == LANGUAGE
    )


def _lacks_ports(item: ast.Node) -> bool:
    return _is_fmu(item) and not item.ports


def lacks_description(definition: ast.Node) -> bool:
    """Whether the ports of a submodel are those of an FMU that cannot be read, so nothing is known of them."""
    if not _lacks_ports(definition):
        return False
    from cspdiag.fmu.description import FmuError, read_description

    assert isinstance(definition, ast.SubmodelDefinition)
    assert definition.external is not None
    try:
        read_description(fmu_path(definition.external))
    except FmuError:
        return True
    return False


def _with_ports(tree: ast.SourceTree) -> ast.SourceTree:
    items = (_described(item) if _lacks_ports(item) else item for item in tree.items)
    return replaced(tree, items=tuple(items))


def _described(definition: ast.Node) -> ast.Node:
    from cspdiag.fmu.description import FmuError, read_description
    from cspdiag.syntax.parser import parse

    assert isinstance(definition, ast.SubmodelDefinition)
    assert definition.external is not None
    path = fmu_path(definition.external)
    try:
        description = read_description(path)
    except FmuError:
        return definition
    rows = [f"  {row}\n" for row in _ports(description)]
    source = SourceFile(name=path, text=f"submodel Described {{\n{''.join(rows)}}}\n")
    for item in parse(source, Report()).items:
        if isinstance(item, ast.SubmodelDefinition):
            return replaced(definition, ports=item.ports)
    return definition


def _ports(description: FmuDescription) -> Iterator[str]:
    for variable in description.variables:
        kind = _TYPES.get(variable.type)
        if variable.causality not in ("input", "output") or kind is None or variable.is_array:
            continue
        unit = unit_text(variable)
        direction = "in" if variable.causality == "input" else "out"
        yield f"{direction} {variable.identifier} : {kind}{f'<{unit}>' if unit else ''}"


def language_type(variable: FmuVariable) -> str | None:
    """The type of the language for a variable; None for what has none, such as a text or an array."""
    return None if variable.is_array else _TYPES.get(variable.type)


def unit_text(variable: FmuVariable) -> str:
    """The unit of a variable as the language spells it; empty for none, and for one that the language does not have."""
    from cspdiag.model.units import Unit, canonical, parse_unit

    unit = variable.unit
    if unit is None or unit.offset != 0.0:
        return ""
    spelled = parse_unit(unit.name)
    if spelled is not None and is_unit(spelled, unit):
        return unit.name if unit.name != "1" else ""
    return canonical(Unit(unit.exponents, angle=unit.angle)).removesuffix("1") if unit.factor == 1.0 else ""


def is_unit(unit: Unit, of: FmuUnit) -> bool:
    """Whether numbers in both units are equal."""
    return unit.exponents == of.exponents and math.isclose(unit.factor, of.factor, rel_tol=1e-9) and of.offset == 0.0
