"""``modelDescription.xml`` and ``buildDescription.xml`` of FMI 2.0 and 3.0."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import assert_never
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from cspdiag.base.record import record
from cspdiag.base.render.snippet import printable
from cspdiag.codegen.fmi.variables import Clock, Variable
from cspdiag.model.types import BoolType, EnumType, IntType, RealType, TimeType
from cspdiag.model.units import Unit, parse_unit

COMPILER_OPTIONS = "-ffp-contract=off"
"""The values of the program are defined to the last bit."""

_BASE = ("m", "kg", "s", "A", "K", "mol", "cd")
_CATEGORIES = (("logStatusError", "Errors"), ("logEvents", "The end of the program"))


@record(kw_only=True)
class Model:
    """What a description tells. ``step`` is the usual length of a step in nanoseconds, ``sources`` are names in
    ``sources/``; ``stops`` says that a step may end before its end.
    """

    name: str
    identifier: str
    token: str
    description: str
    variables: Sequence[Variable]
    sources: Sequence[str]
    step: int
    stops: bool


def model_description(model: Model, fmi: str) -> str:
    """``modelDescription.xml`` for a version of FMI."""
    root = Element("fmiModelDescription", fmiVersion=fmi, modelName=model.name)
    root.set("guid" if fmi == "2.0" else "instantiationToken", model.token)
    if model.description:
        root.set("description", _plain(model.description))
    root.set("generationTool", "cspdiag")
    root.set("variableNamingConvention", "structured")
    root.append(_interface2(model) if fmi == "2.0" else _interface3(model))
    units = sorted({variable.unit for variable in model.variables} - {""})
    if units:
        definitions = SubElement(root, "UnitDefinitions")
        for text in units:
            SubElement(SubElement(definitions, "Unit", name=text), "BaseUnit", _base_unit(text))
    enums = {variable.type.name: variable.type for variable in model.variables if isinstance(variable.type, EnumType)}
    if enums:
        definitions = SubElement(root, "TypeDefinitions")
        for enum in enums.values():
            _enumeration(definitions, enum, fmi)
    categories = SubElement(root, "LogCategories")
    for name, about in _CATEGORIES:
        SubElement(categories, "Category", name=name, description=about)
    SubElement(root, "DefaultExperiment", startTime="0", stopTime="1", stepSize=repr(model.step / 1e9))
    described = SubElement(root, "ModelVariables")
    if fmi == "2.0":
        SubElement(_variable2(described, "time", 0, "independent", "continuous"), "Real")
    else:
        time = {"causality": "independent", "variability": "continuous"}
        SubElement(described, "Float64", {"name": "time", "valueReference": "0", **time})
    for reference, variable in enumerate(model.variables, 1):
        (_described2 if fmi == "2.0" else _described3)(described, variable, reference)
    root.append(_structure(model, fmi))
    return _text(root)


def build_description(model: Model) -> str:
    """``buildDescription.xml`` of FMI 3.0."""
    root = Element("fmiBuildDescription", fmiVersion="3.0")
    build = SubElement(root, "BuildConfiguration", modelIdentifier=model.identifier)
    options = {"language": "C99", "compilerOptions": COMPILER_OPTIONS}
    files = SubElement(build, "SourceFileSet", options)
    for name in model.sources:
        SubElement(files, "SourceFile", name=name)
    return _text(root)


def _interface2(model: Model) -> Element:
    found = Element("CoSimulation", modelIdentifier=model.identifier)
    found.set("canHandleVariableCommunicationStepSize", "true")
    found.set("canNotUseMemoryManagementFunctions", "true")
    found.set("canGetAndSetFMUstate", "true")
    found.set("canSerializeFMUstate", "true")
    files = SubElement(found, "SourceFiles")
    for name in model.sources:
        SubElement(files, "File", name=name)
    return found


def _interface3(model: Model) -> Element:
    found = Element("CoSimulation", modelIdentifier=model.identifier)
    found.set("canGetAndSetFMUState", "true")
    found.set("canSerializeFMUState", "true")
    found.set("canHandleVariableCommunicationStepSize", "true")
    if model.stops:
        found.set("mightReturnEarlyFromDoStep", "true")
    found.set("hasEventMode", "true")
    return found


def _base_unit(text: str) -> dict[str, str]:
    unit = parse_unit(text)
    assert isinstance(unit, Unit)
    found = {name: str(power) for name, power in zip(_BASE, unit.exponents, strict=True) if power}
    if unit.angle:
        found["rad"] = str(unit.angle)
    if unit.scale != (1, 1, 0):
        found["factor"] = repr(unit.factor)
    return found


def _enumeration(definitions: Element, enum: EnumType, fmi: str) -> None:
    if fmi == "2.0":
        place = SubElement(SubElement(definitions, "SimpleType", name=enum.name), "Enumeration")
    else:
        place = SubElement(definitions, "EnumerationType", name=enum.name)
    for number, literal in enumerate(enum.literals, 1):
        SubElement(place, "Item", name=literal, value=str(number))


def _structure(model: Model, fmi: str) -> Element:
    """Which variables are outputs: in FMI 2.0 by their positions, in FMI 3.0 by their references."""
    found = Element("ModelStructure")
    outputs = [(at, item) for at, item in enumerate(model.variables, 1) if item.causality == "output"]
    for part in ("Outputs", "InitialUnknowns") if outputs else ():
        place = SubElement(found, part) if fmi == "2.0" else found
        for reference, variable in outputs:
            known = {"dependencies": ""} if variable.is_delayed else {}
            if fmi == "2.0":
                SubElement(place, "Unknown", {"index": str(reference + 1), **known})
            else:
                SubElement(place, part.removesuffix("s"), {"valueReference": str(reference), **known})
    return found


# ---- Variables


def _variable2(place: Element, name: str, reference: int, causality: str, variability: str) -> Element:
    found = SubElement(place, "ScalarVariable", name=name, valueReference=str(reference))
    found.set("causality", causality)
    found.set("variability", variability)
    return found


def _described2(place: Element, variable: Variable, reference: int) -> None:
    found = _variable2(place, variable.name, reference, variable.causality, _variability(variable))
    if variable.description:
        found.set("description", _plain(variable.description))
    if variable.causality != "input":
        found.set("initial", "calculated" if variable.causality == "output" else "exact")
    attributes: dict[str, str] = {}
    match variable.type:
        case BoolType():
            kind = "Boolean"
        case IntType():
            kind = "Integer"
            if variable.type.bits < 32:
                attributes = {"min": str(variable.type.minimum), "max": str(variable.type.maximum)}
        case RealType() | TimeType():
            kind = "Real"
            attributes = {"unit": variable.unit} if variable.unit else {}
        case EnumType():
            kind = "Enumeration"
            attributes = {"declaredType": variable.type.name}
        case Clock():
            raise AssertionError("FMI 2.0 has no clocks")
        case _:
            assert_never(variable.type)
    if variable.causality != "output":
        attributes["start"] = _start(variable)
    SubElement(found, kind, attributes)


def _described3(place: Element, variable: Variable, reference: int) -> None:
    match variable.type:
        case BoolType():
            kind = "Boolean"
        case IntType():
            kind = f"{'' if variable.type.signed else 'U'}Int{variable.type.bits}"
        case RealType():
            kind = f"Float{variable.type.bits}"
        case TimeType():
            kind = "Float64"
        case EnumType():
            kind = "Enumeration"
        case Clock():
            kind = "Clock"
        case _:
            assert_never(variable.type)
    found = SubElement(place, kind, name=variable.name, valueReference=str(reference))
    if variable.description:
        found.set("description", _plain(variable.description))
    found.set("causality", variable.causality)
    if isinstance(variable.type, Clock):
        found.set("intervalVariability", "triggered")
        return
    found.set("variability", _variability(variable))
    if isinstance(variable.type, EnumType):
        found.set("declaredType", variable.type.name)
    if variable.causality != "input":
        found.set("initial", "calculated" if variable.causality == "output" else "exact")
    if variable.unit:
        found.set("unit", variable.unit)
    if variable.causality != "output":
        found.set("start", _start(variable))


def _variability(variable: Variable) -> str:
    if variable.causality != "parameter":
        return "discrete"
    return "fixed" if variable.is_fixed else "tunable"


def _start(variable: Variable) -> str:
    value = variable.start
    match variable.type:
        case BoolType():
            return "true" if value else "false"
        case EnumType():
            assert isinstance(value, int)
            return str(value + 1)
        case TimeType():
            assert isinstance(value, int)
            return repr(value / 1e9)
        case RealType():
            assert isinstance(value, int | float)
            return repr(float(value)) if math.isfinite(value) else "0"
        case IntType():
            return str(value)
        case Clock():
            raise AssertionError("a clock has no value at the start")
    assert_never(variable.type)


def _plain(text: str) -> str:
    return printable(" ".join(text.split()))


def _text(root: Element) -> str:
    indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + tostring(root, encoding="unicode") + "\n"
