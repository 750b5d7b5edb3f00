"""Values that random programs compute with: types, and expressions of each type, as text.

Faults are rare, but occur: whole numbers overflow, divisors are zero, indexes are out of range.
"""

from __future__ import annotations

from typing import Protocol

from hypothesis import strategies as st

DEFINITIONS = """enum Mode { idle, run, halt }

struct Pose {
  x : double
  n : int
}

struct Box {
  pose  : Pose
  marks : int[3]
}

const width = 3
const gain  = 0.25
const pause = 2 ms
"""

INITIAL = {
    "int": "2", "int8": "int8(3)", "uint16": "uint16(40000)", "double": "1.5", "float": "float(0.5)", "bool": "false",
    "time": "1 ms", "Mode": "Mode.idle", "Pose": "Pose(x = 0.0, n = 1)", "int[3]": "[1, 2, 3]",
    "Box": "Box(pose = Pose(x = 0.5, n = 0), marks = [4, 5, 6])",
}  # fmt: skip
"""The types of values, with the initial values of variables."""

LITERALS = {
    "int": ["0", "1", "7", "-3", "width"],
    "int8": ["int8(100)", "int8(-3)"],
    "uint16": ["uint16(7)", "uint16(60000)"],
    "double": ["0.5", "1.25", "-2.0", "gain"],
    "float": ["float(0.1)", "float(3.5)"],
    "bool": ["true", "false"],
    "time": ["300 us", "pause"],
    "Mode": ["Mode.idle", "Mode.run", "Mode.halt"],
    "Pose": ["Pose(x = 0.5, n = 2)"],
    "int[3]": ["[0, 1, 5]"],
    "Box": ["Box(pose = Pose(x = 0.25, n = 3), marks = [0, 1, 2])"],
}

PRESENT = {"time": ["now"]}
"""Expressions that have a value only while a program runs."""

FORMS: dict[str, list[tuple[str, tuple[str, ...]]]] = {
    "int": [
        ("({} + {})", ("int", "int")), ("({} - {})", ("int", "int")), ("({} * {})", ("int", "int")),
        ("({} / {})", ("int", "int")), ("({} % {})", ("int", "int")), ("int({})", ("int8",)), ("int({})", ("uint16",)),
        ("{}.n", ("Pose",)), ("{}.pose.n", ("Box",)), ("{}.marks[2]", ("Box",)), ("{}[1]", ("int[3]",)),
        ("int({})", ("double",)), ("(-{})", ("int",)), ("abs({})", ("int",)), ("sign({})", ("int",)),
        ("max({}, {})", ("int", "int")), ("limit({}, -9, 9)", ("int",)), ("({} ^ 2)", ("int",)),
        ("(if {} then {} else {})", ("bool", "int", "int")),
    ],
    "int8": [
        ("int8({})", ("int",)), ("({} + {})", ("int8", "int8")), ("({} * {})", ("int8", "int8")), ("(-{})", ("int8",)),
    ],
    "uint16": [("uint16({})", ("int",)), ("({} + {})", ("uint16", "uint16")), ("({} - {})", ("uint16", "uint16"))],
    "double": [
        ("({} + {})", ("double", "double")), ("({} - {})", ("double", "double")), ("({} * {})", ("double", "double")),
        ("({} / {})", ("double", "double")), ("double({})", ("int",)),
        ("{}.x", ("Pose",)), ("{}.pose.x", ("Box",)), ("double({})", ("float",)), ("sqrt({})", ("double",)),
        ("limit({}, -10.0, 10.0)", ("double",)), ("({} ^ {})", ("double", "double")), ("abs({})", ("double",)),
        ("min({}, {})", ("double", "double")), ("sign({})", ("double",)), ("exp({})", ("double",)),
        ("log({})", ("double",)), ("sin({})", ("double",)), ("cos({})", ("double",)), ("tan({})", ("double",)),
        ("atan2({}, {})", ("double", "double")), ("asin({})", ("double",)), ("acos({})", ("double",)),
        ("atan({})", ("double",)), ("floor({})", ("double",)), ("ceil({})", ("double",)),
        ("round({})", ("double",)), ("(-{})", ("double",)),
    ],
    "float": [
        ("({} + {})", ("float", "float")), ("({} * {})", ("float", "float")), ("({} / {})", ("float", "float")),
        ("float({})", ("double",)), ("float({})", ("int",)), ("max({}, {})", ("float", "float")),
    ],
    "bool": [
        ("({} < {})", ("int", "int")), ("({} == {})", ("int8", "int8")), ("({} >= {})", ("double", "double")),
        ("({} and {})", ("bool", "bool")), ("({} or {})", ("bool", "bool")), ("(not {})", ("bool",)),
        ("({} > {})", ("float", "float")), ("({} == {})", ("Mode", "Mode")), ("({} <= {})", ("time", "time")),
        ("({} != {})", ("uint16", "uint16")), ("({} == {})", ("Pose", "Pose")),
    ],
    "time": [("({} + {})", ("time", "time")), ("({} * {})", ("time", "int")), ("({} % {})", ("time", "time")),
        ("max({}, {})", ("time", "time"))],
    "Mode": [("(if {} then {} else {})", ("bool", "Mode", "Mode"))],
    "Pose": [
        ("Pose(x = {}, n = {})", ("double", "int")), ("(if {} then {} else {})", ("bool", "Pose", "Pose")),
        ("{}.pose", ("Box",)),
    ],
    "int[3]": [("[{}, {}, {}]", ("int", "int", "int")), ("{}.marks", ("Box",))],
    "Box": [("Box(pose = {}, marks = {})", ("Pose", "int[3]"))],
}  # fmt: skip


class Variables(Protocol):
    """The variables that expressions may use."""

    def variable(self, kind: str) -> str:
        """The variable of a type."""
        ...

    def constants(self, kind: str) -> list[str]:
        """Parameters of a type."""
        ...


def literal(draw: st.DrawFn, part: Variables, kind: str) -> str:
    """A literal, a constant or a variable."""
    variable = part.variable(kind)
    return draw(st.sampled_from([*LITERALS[kind], *PRESENT.get(kind, ()), *part.constants(kind), variable, variable]))


def value(draw: st.DrawFn, part: Variables, kind: str, depth: int = 2) -> str:
    """An expression of a type."""
    if depth == 0 or draw(st.booleans()):
        return literal(draw, part, kind)
    form, kinds = draw(st.sampled_from(FORMS[kind]))
    inner = [value(draw, part, k, depth - 1) for k in kinds]
    if not form.startswith("(if"):
        # Only a member of a variable is used, because a constant out of range, or divided by zero, would be refused.
        inner[0] = part.variable(kinds[0])
    if form[4:5] in ("/", "%"):
        inner[1] = part.variable(kinds[1])
    return form.format(*inner)
