"""Parameters of programs, constants that follow from them, and expressions of such values, as text."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from random import Random

TYPES = """enum Mode { slow, fast, off }

struct Shape {
  rise  : time
  bends : double[2]
  level : int8
  mode  : Mode
}

struct Gains {
  kp    : double
  order : int
  ratio : float
  on    : bool
  shape : Shape
}
"""

FIELDS: Mapping[str, Sequence[tuple[str, str]]] = {
    "Shape": [(".rise", "time"), (".bends", "double[2]"), (".level", "int8"), (".mode", "Mode")],
    "Gains": [(".kp", "double"), (".order", "int"), (".ratio", "float"), (".on", "bool"), (".shape", "Shape")],
    "double[2]": [("[0]", "double"), ("[1]", "double")],
    "double[3]": [("[0]", "double"), ("[1]", "double"), ("[2]", "double")],
    "int[3]": [("[0]", "int"), ("[1]", "int"), ("[2]", "int")],
    "Shape[2]": [("[0]", "Shape"), ("[1]", "Shape")],
}
"""What is reached in a value of a type, by a field or an index, with its type."""

LITERALS: Mapping[str, Sequence[str]] = {
    "double": ["0.5", "1.5", "-2.0", "0.25", "3.0", "0.0"],
    "float": ["float(0.5)", "float(-1.25)", "float(3.0)"],
    "int": ["0", "1", "2", "3", "5", "-2"],
    "int8": ["int8(1)", "int8(4)", "int8(-3)", "int8(60)"],
    "uint16": ["uint16(1)", "uint16(9)", "uint16(40000)"],
    "bool": ["true", "false"],
    "time": ["1 ms", "2 ms", "3 ms", "500 us", "1700 us"],
    "Mode": ["Mode.slow", "Mode.fast", "Mode.off"],
}
"""Literals of the types that have them."""

BUILT: Mapping[str, tuple[str, Sequence[str]]] = {
    "Shape": ("Shape(rise = {}, bends = {}, level = {}, mode = {})", ("time", "double[2]", "int8", "Mode")),
    "Gains": (
        "Gains(kp = {}, order = {}, ratio = {}, on = {}, shape = {})", ("double", "int", "float", "bool", "Shape")
    ),
    "double[2]": ("[{}, {}]", ("double",) * 2),
    "double[3]": ("[{}, {}, {}]", ("double",) * 3),
    "int[3]": ("[{}, {}, {}]", ("int",) * 3),
    "Shape[2]": ("[{}, {}]", ("Shape",) * 2),
}  # fmt: skip
"""How a value of a type is built of its parts."""

PARAMETERS = (
    "double", "double", "double", "float", "int", "int", "int8", "uint16", "bool", "bool", "time", "time", "Mode",
    "Gains", "Gains", "Shape", "double[2]", "double[3]", "int[3]", "Shape[2]",
)  # fmt: skip

FORMS: Mapping[str, Sequence[tuple[str, Sequence[str]]]] = {
    "double": [
        ("({} + {})", ("double", "double")), ("({} - {})", ("double", "double")), ("({} * {})", ("double", "double")),
        ("({} * {})", ("double", "double")), ("({} / (3.5 + abs({})))", ("double", "double")),
        ("double({})", ("int",)), ("double({})", ("int8",)), ("double({})", ("float",)), ("(-{})", ("double",)),
        ("limit({}, -9.0, 9.0)", ("double",)), ("max({}, {})", ("double", "double")), ("abs({})", ("double",)),
        ("sqrt(abs({}))", ("double",)), ("(if {} then {} else {})", ("bool", "double", "double")),
        ("{}[abs({}) % 3]", ("double[3]", "int")),
    ],
    "float": [("({} * {})", ("float", "float")), ("({} + {})", ("float", "float")), ("float({})", ("int8",))],
    "int": [
        ("({} + {})", ("int", "int")), ("({} - {})", ("int", "int")), ("({} * {})", ("int", "int")),
        ("({} % 7)", ("int",)), ("int({})", ("int8",)), ("int({})", ("uint16",)), ("(-{})", ("int",)),
        ("int(limit({}, -99.0, 99.0))", ("double",)), ("max({}, {})", ("int", "int")),
        ("(if {} then {} else {})", ("bool", "int", "int")),
    ],
    "int8": [("(-{})", ("int8",)), ("int8({} % 50)", ("int",)), ("min({}, {})", ("int8", "int8"))],
    "uint16": [("uint16(abs({}) % 1000)", ("int",)), ("max({}, {})", ("uint16", "uint16"))],
    "bool": [
        ("({} < {})", ("int", "int")), ("({} >= {})", ("double", "double")), ("({} == {})", ("Mode", "Mode")),
        ("({} and {})", ("bool", "bool")), ("({} or {})", ("bool", "bool")), ("(not {})", ("bool",)),
        ("({} <= {})", ("time", "time")), ("({} != {})", ("int8", "int8")),
    ],
    "time": [("max({}, {})", ("time", "time")), ("({} + {})", ("time", "time")), ("({} * 2)", ("time",))],
    "Mode": [("(if {} then {} else {})", ("bool", "Mode", "Mode"))],
    "Gains": [("(if {} then {} else {})", ("bool", "Gains", "Gains"))],
    "Shape": [("(if {} then {} else {})", ("bool", "Shape", "Shape"))],
}  # fmt: skip
"""Expressions that have a value for nearly all operands."""

FAULTING: Mapping[str, Sequence[tuple[str, Sequence[str]]]] = {
    "double": [
        ("({} / {})", ("double", "double")), ("sqrt({})", ("double",)), ("log({})", ("double",)),
        ("exp({})", ("double",)), ("({} * {} * 1e300)", ("double", "double")), ("quantize({}, {})", ("double",) * 2),
        ("{}[{}]", ("double[3]", "int")),
    ],
    "int": [
        ("({} / {})", ("int", "int")), ("({} % {})", ("int", "int")), ("int({})", ("double",)),
        ("{}[{}]", ("int[3]", "int")), ("({} * 4000000000)", ("int",)), ("(2 ^ {})", ("int",)),
    ],
    "int8": [("int8({})", ("int",)), ("({} + {})", ("int8", "int8")), ("({} * {})", ("int8", "int8"))],
    "uint16": [("uint16({})", ("int",)), ("({} - {})", ("uint16", "uint16"))],
    "float": [("float({})", ("double",)), ("({} / {})", ("float", "float"))],
    "time": [("({} - {})", ("time", "time")), ("({} * {})", ("time", "int")), ("({} / {})", ("time", "int"))],
}  # fmt: skip
"""Expressions that are faults for some operands."""


def parts(text: str, kind: str) -> Iterator[tuple[str, str]]:
    """A value with everything that is reached in it, as text and type."""
    yield text, kind
    for suffix, inner in FIELDS.get(kind, ()):
        yield from parts(text + suffix, inner)


def numbers(text: str, kind: str) -> Iterator[tuple[str, str]]:
    """The parts of a value that have no parts themselves."""
    return (part for part in parts(text, kind) if part[1] not in FIELDS)


def built(draw: Random, kind: str) -> str:
    """A value of a type, of literals alone."""
    if kind in LITERALS:
        return draw.choice(LITERALS[kind])
    form, kinds = BUILT[kind]
    return form.format(*(built(draw, inner) for inner in kinds))


@dataclass
class Scope:
    """What an expression may use: names with their types; in ``equations`` a time is a number of seconds."""

    draw: Random
    names: Sequence[tuple[str, str]] = ()
    equations: bool = False
    faulting: float = 0.0
    """How often an operation may be a fault."""
    literals: float = 0.3
    """How often a literal is taken where there is a name."""

    def with_names(self, *names: tuple[str, str]) -> Scope:
        """The scope with more names; those are used as often as all the others together."""
        copies = max(1, len(self.names) // max(1, len(names)))
        return Scope(self.draw, (*self.names, *names * copies), self.equations, self.faulting, self.literals)

    def named(self, kind: str) -> str | None:
        """A name of a type, or what is reached in one; None if there is none."""
        found = [text for name, whole in self.names for text, inner in parts(name, whole) if inner == kind]
        return self.draw.choice(found) if found else None

    def value(self, kind: str, depth: int = 2) -> str:
        """An expression of a type."""
        draw = self.draw
        if depth <= 0 or draw.random() < 0.3:
            return self._simple(kind)
        risky = draw.random() < self.faulting and kind in FAULTING
        forms = FAULTING[kind] if risky else FORMS.get(kind, ())
        if self.equations:
            forms = [form for form in forms if kind != "time"]
            if kind == "double" and draw.random() < 0.15:
                return f"({self.value('time', 0)} / 1 ms)"
        if not forms or (kind in BUILT and draw.random() < 0.5):
            return self._simple(kind, depth)
        form, kinds = draw.choice(forms)
        return form.format(*(self.value(inner, depth - 1) for inner in kinds))

    def _simple(self, kind: str, depth: int = 0) -> str:
        name = self.named(kind)
        if name is not None and self.draw.random() >= self.literals:
            return name
        if kind in LITERALS:
            return self.draw.choice(LITERALS[kind])
        if name is not None and depth <= 0:
            return name
        form, kinds = BUILT[kind]
        return form.format(*(self.value(inner, depth - 1) for inner in kinds))


@dataclass(frozen=True)
class Declared:
    """The parameters of a program and the constants that follow from them, by name and type, and their text."""

    text: str
    parameters: Sequence[tuple[str, str]]
    constants: Sequence[tuple[str, str]]

    @property
    def names(self) -> Sequence[tuple[str, str]]:
        """Both."""
        return (*self.parameters, *self.constants)


def declared(draw: Random) -> Declared:
    """Some parameters, and constants that follow from them, some of which cannot always be computed."""
    found: list[tuple[str, str]] = []
    lines = []
    for number, kind in enumerate(draw.sample(PARAMETERS, draw.randint(4, 9))):
        name = f"p{number}"
        lines.append(f"parameter {name} : {kind} = {built(draw, kind)}")
        found.append((name, kind))
    following: list[tuple[str, str]] = []
    for number in range(draw.randint(0, 5)):
        kind = draw.choice(
            ["double", "double", "int", "int", "bool", "time", "int8", "float", "Mode", "Gains", "Shape"]
        )
        scope = Scope(draw, (*found, *following), faulting=0.25, literals=0.1)
        following.append((f"c{number}", kind))
        lines.append(f"const c{number} : {kind} = {scope.value(kind)}")
    draw.shuffle(lines)
    return Declared("\n".join([*lines, ""]), found, following)
