"""What an FMU says about itself: ``modelDescription.xml`` of FMI 2.0 and 3.0."""

from __future__ import annotations

import re
import zipfile
from collections.abc import Collection, Iterator, Mapping
from functools import lru_cache
from xml.etree.ElementTree import Element, ParseError, fromstring

from cspdiag.base.errors import CspdiagError
from cspdiag.base.record import record

_LARGEST = 64 * 1024 * 1024
"""Bytes of the longest description that is read."""
_SCALARS = ("Real", "Integer", "Boolean", "Enumeration", "String")
_BASE = ("m", "kg", "s", "A", "K", "mol", "cd")


class FmuError(CspdiagError):
    """An FMU cannot be read or used; the message begins with its name. ``advice`` says what to do,
    if that is not clear."""

    def __init__(self, message: str, advice: str) -> None:
        super().__init__(f"{message}; {advice}" if advice else message)
        self.message = message
        self.advice = advice


@record(kw_only=True)
class FmuUnit:
    """A unit: the exponents of m, kg, s, A, K, mol, cd, and of rad, its factor and offset to these."""

    name: str
    exponents: tuple[int, ...]
    angle: int
    factor: float
    offset: float


@record(kw_only=True)
class FmuVariable:
    """A variable; ``type`` is that of FMI (``Real``, ``Float64``), ``size`` the number of elements of an array."""

    name: str
    reference: int
    type: str
    causality: str
    variability: str
    unit: FmuUnit | None = None
    is_array: bool = False
    lacks_zero: bool = False
    """Whether it is of an enumeration without the number 0, which inputs have before they are written."""

    @property
    def identifier(self) -> str:
        """The name as the language can spell it."""
        return re.sub(r"[^A-Za-z0-9_]+", "_", self.name).strip("_")


@record(kw_only=True)
class FmuDescription:
    """The description of an FMU. ``co_simulation`` and ``model_exchange`` are the names of its binary for them, None if
    it is not made for that. ``states`` is the number of its continuous states, ``indicators`` that of its event
    indicators.
    """

    version: str
    name: str
    token: str
    co_simulation: str | None
    model_exchange: str | None
    variables: tuple[FmuVariable, ...]
    states: int
    indicators: int

    def named(self, name: str) -> FmuVariable | None:
        """The variable of a port of this name."""
        exact = (item for item in self.variables if item.name == name)
        alike = (item for item in self.variables if item.identifier == name)
        return next(exact, None) or next(alike, None)


def read_description(path: str) -> FmuDescription:
    """The description in an archive. Raises FmuError, also if the file cannot be read."""
    import os

    try:
        facts = os.stat(path)
    except OSError as problem:
        raise FmuError(
            f"{path} cannot be read: {problem.strerror}", "paths are relative to the file that names them"
        ) from None
    return _read(path, facts.st_mtime_ns, facts.st_size)


@lru_cache(maxsize=32)
def _read(path: str, changed: int, size: int) -> FmuDescription:
    try:
        with zipfile.ZipFile(path) as archive:
            entry = archive.getinfo("modelDescription.xml")
            if entry.file_size > _LARGEST:
                raise FmuError(f"{path} has a description of {entry.file_size} bytes", "that is no description")
            text = archive.read(entry)
    except (zipfile.BadZipFile, zipfile.LargeZipFile, EOFError, NotImplementedError, OSError, RuntimeError):
        raise FmuError(f"{path} is no FMU: it is no archive in the format zip", "export it again") from None
    except KeyError:
        raise FmuError(f"{path} is no FMU: it has no modelDescription.xml", "export it again") from None
    try:
        root = fromstring(text)
    except (ParseError, ValueError) as problem:
        raise FmuError(f"{path} has a damaged modelDescription.xml: {problem}", "export it again") from None
    try:
        return _description(path, root)
    except KeyError as problem:
        raise FmuError(f"{path} has a modelDescription.xml that lacks {problem}", "export it again") from None
    except ValueError as problem:
        raise FmuError(f"{path} has a modelDescription.xml with a wrong number: {problem}", "export it again") from None


def _description(path: str, root: Element) -> FmuDescription:
    version = root.attrib["fmiVersion"]
    if not re.match(r"[23]\.0", version):
        raise FmuError(f"{path} is an FMU for FMI {version}", "export it for FMI 2.0 or 3.0")
    is_new = version.startswith("3")
    units = dict(_units(root))
    types = {
        item.attrib["name"]: units.get(inner.get("unit", ""))
        for item in root.iterfind("TypeDefinitions/*")
        for inner in (item, *item)
        if inner.get("unit")
    }
    with_zero = {
        item.attrib["name"]
        for item in root.iterfind("TypeDefinitions/*")
        if any(literal.get("value") == "0" for literal in item.iter("Item"))
    }
    structure = root.find("ModelStructure")
    states = "ContinuousStateDerivative" if is_new else "Derivatives/Unknown"
    indicators = int(root.get("numberOfEventIndicators", "0"))
    if is_new and structure is not None:
        indicators = len(structure.findall("EventIndicator"))
    return FmuDescription(
        version=version[:3],
        name=root.attrib["modelName"],
        token=root.attrib["instantiationToken" if is_new else "guid"],
        co_simulation=_identifier(root, "CoSimulation"),
        model_exchange=_identifier(root, "ModelExchange"),
        variables=tuple(_variables(root, is_new, units, types, with_zero)),
        states=0 if structure is None else len(structure.findall(states)),
        indicators=indicators,
    )


def _identifier(root: Element, kind: str) -> str | None:
    found = root.find(kind)
    return None if found is None else found.attrib["modelIdentifier"]


def _units(root: Element) -> Iterator[tuple[str, FmuUnit | None]]:
    for item in root.iterfind("UnitDefinitions/Unit"):
        base = item.find("BaseUnit")
        if base is None:
            continue
        yield (
            item.attrib["name"],
            FmuUnit(
                name=item.attrib["name"],
                exponents=tuple(int(base.get(name, "0")) for name in _BASE),
                angle=int(base.get("rad", "0")),
                factor=float(base.get("factor", "1")),
                offset=float(base.get("offset", "0")),
            ),
        )


def _variables(
    root: Element,
    is_new: bool,
    units: Mapping[str, FmuUnit | None],
    types: Mapping[str, FmuUnit | None],
    with_zero: Collection[str],
) -> Iterator[FmuVariable]:
    for item in root.iterfind("ModelVariables/*"):
        inner = item if is_new else next((part for part in item if part.tag in _SCALARS), item)
        unit = units.get(inner.get("unit", "")) or types.get(inner.get("declaredType", ""))
        yield FmuVariable(
            name=item.attrib["name"],
            reference=int(item.attrib["valueReference"]),
            type=inner.tag,
            causality=item.get("causality", "local"),
            variability=item.get(
                "variability", "continuous" if inner.tag in ("Real", "Float64", "Float32") else "discrete"
            ),
            unit=unit,
            is_array=item.find("Dimension") is not None,
            lacks_zero=inner.tag == "Enumeration" and inner.get("declaredType") not in with_zero,
        )
