"""Random programs that compute with what is known before they run: parameters near the limits of their types,
replicators, constants, arrays of them.

Nearly everything is below a ``catch Fault``, and much of it faults: in assignments, conditions, indexes, durations of
delays and guards, and equations of laws. Each process and each law occurs with several arguments, for which different
parts of it fault.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from random import Random

from tests.conformance.random.nodes import Node, Program

VALUES = {
    "int8": ["127", "-128", "100", "-100", "1", "0", "-1", "3"],
    "int16": ["32767", "-32768", "200", "-2", "0", "1"],
    "uint8": ["255", "0", "1", "200", "16"],
    "int": ["9223372036854775807", "-9223372036854775808", "4294967296", "0", "1", "2", "3", "-1", "-3"],
    "time": ["9223372036854775807 ns", "1 ms", "0 ms", "2 ms", "200000000 s"],
    "double": ["0.0", "1.0", "-1.0", "2.5", "1e300", "-1e300", "1e-300", "9.3e18"],
}
PARAMETERS = {"k8": "int8", "k16": "int16", "u8": "uint8", "k": "int", "at": "int", "w": "time", "x": "double"}
ARRAYS = {"table": "int", "small": "int8", "given": "int"}
"""Two constants and a parameter, of three elements each."""
LITERALS = {
    "int8": ["int8(1)", "int8(-1)", "int8(100)"], "int16": ["int16(300)", "int16(-1)"],
    "uint8": ["uint8(1)", "uint8(17)"],
    "int": ["1", "2", "3", "-1", "7", "1000000007"], "time": ["1 ms", "3 ms", "1 s"], "double": ["0.5", "2.0", "-1.0"],
}  # fmt: skip
INITIAL = {"int8": "3", "int16": "3", "uint8": "3", "int": "1", "time": "1 ms", "double": "1.5"}
FORMS: dict[str, list[tuple[str, tuple[str, ...]]]] = {
    "int": [
        *[(f"({{}} {operator} {{}})", ("int", "int")) for operator in "+-*/%"] * 2,
        ("({} ^ 2)", ("int",)), ("(2 ^ {})", ("int",)), ("(-{})", ("int",)), ("abs({})", ("int",)),
        ("sign({})", ("int",)),
        ("min({}, {})", ("int", "int")), ("max({}, {}, {})", ("int", "int", "int")),
        ("limit({}, {}, 9)", ("int", "int")),
        ("int({})", ("int8",)), ("int({})", ("uint8",)), ("int({})", ("int16",)), ("int({})", ("double",)),
        ("(if {} then {} else {})", ("bool", "int", "int")), ("table[{}]", ("int",)), ("given[{}]", ("int",)),
    ],
    "int8": [
        *[(f"({{}} {operator} {{}})", ("int8", "int8")) for operator in "+-*/%"],
        ("(-{})", ("int8",)), ("abs({})", ("int8",)), ("int8({})", ("int",)), ("int8({})", ("double",)),
        ("small[{}]", ("int",)),
        ("min({}, {})", ("int8", "int8")), ("(if {} then {} else {})", ("bool", "int8", "int8")),
    ],
    "int16": [("({} + {})", ("int16", "int16")), ("({} * {})", ("int16", "int16")), ("int16({})", ("int",)),
     ("int16({})", ("uint8",))],
    "uint8": [("({} - {})", ("uint8", "uint8")), ("({} + {})", ("uint8", "uint8")), ("uint8({})", ("int8",)),
     ("uint8({})", ("int",))],
    "time": [
        ("({} + {})", ("time", "time")), ("({} - {})", ("time", "time")), ("({} * {})", ("time", "int")),
        ("({} / {})", ("time", "int")), ("({} % {})", ("time", "time")), ("(-{})", ("time",)),
        ("max({}, {})", ("time", "time")),
        ("abs({})", ("time",)), ("(if {} then {} else {})", ("bool", "time", "time")),
    ],
    "double": [
        *[(f"({{}} {operator} {{}})", ("double", "double")) for operator in "+-*/"],
        ("sqrt({})", ("double",)), ("log({})", ("double",)), ("asin({})", ("double",)), ("double({})", ("int",)),
        ("double({})", ("int8",)), ("limit({}, {}, 5.0)", ("double", "double")),
        ("quantize({}, {})", ("double", "double")),
        ("({} ^ {})", ("double", "double")),
    ],
    "bool": [
        ("({} < {})", ("int", "int")), ("({} == {})", ("int8", "int8")), ("({} <= {})", ("time", "time")),
        ("({} > {})", ("double", "double")), ("({} and {})", ("bool", "bool")), ("({} or {})", ("bool", "bool")),
        ("(not {})", ("bool",)), ("({} != {})", ("uint8", "uint8")),
    ],
}  # fmt: skip


@dataclass
class Scope:
    """The context of an expression: the names that it may use."""

    draw: Random
    names: dict[str, list[str]]
    """Names by type."""
    varies: bool = False
    """Whether the value of some name is not constant, so the compiler cannot refuse an expression with it."""
    indices: list[str] = field(default_factory=list)

    def within(self, index: str) -> Scope:
        """The scope below a replicator."""
        return Scope(self.draw, self.names, self.varies, [*self.indices, index])

    def value(self, kind: str, depth: int = 2) -> str:
        """An expression that the compiler does not report to fault."""
        draw = self.draw
        named = [*self.names.get(kind, ()), *(self.indices * 2 if kind == "int" else ())]
        if kind == "bool" and depth <= 0:
            return f"({self.name('int')} < {draw.choice(LITERALS['int'])})"
        if depth <= 0 or (kind != "bool" and draw.random() < 0.35):
            return draw.choice(named)
        form, kinds = draw.choice([form for form in FORMS[kind] if {*form[1]} <= {*self.names, "bool"}])
        parts = [self.value(inner, depth - 1) for inner in kinds]
        if len(parts) > 1 and kinds[1] in LITERALS and draw.random() < 0.3:
            parts[1] = draw.choice(LITERALS[kinds[1]])
        return form.format(*parts)

    def name(self, kind: str) -> str:
        """A name."""
        return self.draw.choice(self.names[kind])


def _arguments(draw: Random) -> str:
    given = [f"{name} = {_literal(kind, draw)}" for name, kind in PARAMETERS.items()]
    elements = ", ".join(draw.choice(VALUES["int"]) for _ in range(3))
    return ", ".join([*given, f"given = [{elements}]"])


def _literal(kind: str, draw: Random) -> str:
    return draw.choice(VALUES[kind])


DECLARED = ", ".join([*(f"{name}: {kind}" for name, kind in PARAMETERS.items()), "given: int[3]"])
BY_TYPE: dict[str, list[str]] = {}
for _name, _kind in PARAMETERS.items():
    BY_TYPE.setdefault(_kind, []).append(_name)


def law(draw: Random, name: str) -> str:
    """A submodel with an output, a state, and names for values of parameters alone and of others."""
    names = {kind: list(found) for kind, found in BY_TYPE.items()}
    names.pop("time")
    items = []
    for number in range(draw.randint(1, 4)):
        kind = draw.choice(["int", "int", "int8", "double"])
        items.append(f"  let m{number} = {Scope(draw, names).value(kind)}")
        names[kind] = [*names[kind], f"m{number}", f"m{number}"]
    names["int"] += ["u", "s", "s"]
    scope = Scope(draw, names, varies=True)
    if draw.random() < 0.4:
        items.append(f"  let late = {scope.value('int')}")
        names["int"] = [*names["int"], "late"]
    inner = draw.random() < 0.3
    if inner:
        items += ["  inner : Inner(x)", f"  inner.u = {scope.value('int')}"]
        names["int"] = [*names["int"], "inner.y"]
    output = Scope(draw, names, varies=True).value("int")
    following = Scope(draw, names, varies=True).value("int")
    head = [
        f"submodel {name}({DECLARED}) {{",
        "  in  u : int",
        "  out y : int",
        f"  state s : int = {draw.randint(0, 3)}",
    ]
    return "\n".join([*head, *items, f"  y = {output}", f"  next s = {following}", "}", ""])


INNER = """submodel Inner(x: double) {
  in  u : int
  out y : int
  let m = exp(x)
  y = if m > 2.0 then u else u + 1
}
"""


@dataclass
class Unit:
    """A process under construction."""

    draw: Random
    laws: int
    numbers: int = 0

    def fresh(self) -> int:
        """A number to be written where a fault was caught."""
        self.numbers += 1
        return self.numbers

    def scope(self) -> Scope:
        """Parameters, and variables here and there."""
        names = {kind: [*found * 2, f"v_{kind}"] for kind, found in BY_TYPE.items()}
        names["int"] += ["own[at]", "given[1]"]
        return Scope(self.draw, names, varies=True)

    def step(self, depth: int) -> Node:
        """A statement, which may fault, and what is written if it does."""
        inner = self.plain(depth)
        if self.draw.random() < 0.04:
            return inner
        return Node(f"({{}} catch Fault -> o ! {self.fresh() + 1000})", (inner,))

    def turns(self, index: str, within: Scope, depth: int) -> Node:
        """A replicated sequence that computes with its index, either short or so long that it is a loop."""
        draw = self.draw
        array = draw.choice(["own", "table", "given", "[7, 8, 9]"])
        forms = [
            f"o ! {array}[{within.value('int', 1)}]",
            f"(own[{within.value('int', 1)}] := {within.value('int')} ; o ! {index})",
            f"(if {index} % 3 == {draw.randint(0, 3)} then o ! {within.value('int')} else v_int := {index})",
            f"(if {within.value('bool', 1)} then o ! {index})",
            f"(wait {draw.choice(['1 us', '0 us'])} * {index} ; v_int := {within.value('int', 1)})",
            f"(after 1 us * ({index} % 7) -> o ! {index} {draw.choice(['[]', '[]>'])} after 3 us -> o ! v_int)",
            f"((o ! {within.value('int')} catch Fault -> v_int := {index}) ; o ! v_int)",
        ]
        body = draw.choice(forms)
        if depth > 0 and draw.random() < 0.3:
            other = f"i{self.fresh()}"
            few = self.turns(other, within.within(other), 0)
            body = str(few) if draw.random() < 0.5 else f"({body} ; {few})"
        return Node(f"(seq {index} < {draw.choice((2, 3, 5, 66, 66, 200) if depth > 0 else (2, 3, 66))} : {body})")

    def plain(self, depth: int) -> Node:
        """A statement."""
        draw, scope = self.draw, self.scope()
        index = f"i{self.fresh()}"
        within = scope.within(index)
        match draw.choice(STATEMENTS if depth > 0 else STATEMENTS[:-6]):
            case "assign":
                kind = draw.choice(sorted(INITIAL))
                shown = {"time": "if v_time > 1 ms then 1 else 0", "double": "if v_double > 1.0 then 1 else 0"}
                return Node(f"(v_{kind} := {scope.value(kind)} ; o ! {shown.get(kind, f'int(v_{kind})')})")
            case "write":
                return Node(f"(o ! {scope.value('int', 3)})")
            case "element":
                return Node(f"(own[{scope.value('int', 1)}] := {scope.value('int')} ; o ! own[0] + own[1] % 7)")
            case "read":
                return Node(f"(o ! {draw.choice(['own', 'table', 'given', '[7, 8, 9]'])}[{scope.value('int', 1)}])")
            case "wait":
                return Node(f"((wait {scope.value('time')}) interrupt after 2 ms -> o ! 99)")
            case "after":
                condition = f"when {scope.value('bool', 1)} & " if draw.random() < 0.3 else ""
                operator = draw.choice(["[]", "[]>"])
                return Node(f"({condition}after {scope.value('time')} -> o ! 1 {operator} after 1 ms -> o ! 2)")
            case "interrupt":
                condition = f"when {scope.value('bool', 1)} & " if draw.random() < 0.3 else ""
                return Node(f"((wait 1 ms ; o ! 1) interrupt {condition}after {scope.value('time')} -> o ! 2)")
            case "guard":
                condition = f"when {scope.value('bool', 1)} & " if draw.random() < 0.3 else ""
                return Node(f"({condition}o ! {scope.value('int')} -> o ! 1 [] after 1 ms -> o ! 2)")
            case "replicated":
                kind, event = draw.choice(["alt", "prialt"]), draw.choice(["skip", f"after 1 ms * ({index} + 1)"])
                condition = f"open[{within.value('int', 1)}]" if draw.random() < 0.5 else within.value("bool", 1)
                return Node(f"({kind} {index} < {draw.randint(1, 4)} : when {condition} & {event} -> o ! {index})")
            case "times":
                return Node(
                    f"((par {index} < {draw.randint(1, 4)} : wait {within.value('time')}) interrupt after 2 ms -> o ! "
                    "98)"
                )
            case "elements":
                return self.turns(index, within, depth)
            case "law":
                return Node(f"(law{draw.randrange(self.laws)} ; o ! of_law)")
            case "if":
                return Node(
                    f"(if {scope.value('bool')} then {{}} else {{}})", (self.step(depth - 1), self.step(depth - 1))
                )
            case "par":
                wait = f"((wait {scope.value('time')}) interrupt after 2 ms -> skip)"
                return Node(f"({{}} || {wait})", (self.step(depth - 1),))
            case _:
                return Node("", tuple(self.step(depth - 1) for _ in range(2)), " ; ")


STATEMENTS = (
    "assign", "assign", "assign", "write", "write", "element", "read", "wait", "after", "after", "interrupt", "guard",
    "replicated",
    "times", "elements", "law", "law", "if", "if", "par", "par", "seq", "seq",
)  # fmt: skip


def known(seed: int) -> Program:
    """The program of a seed."""
    draw = Random(seed)
    laws = [f"Law{number}" for number in range(2)]
    arrays = [f"const table : int[3] = [{', '.join(draw.choice(VALUES['int']) for _ in range(3))}]"]
    arrays.append(f"const small : int8[3] = [{', '.join(draw.choice(VALUES['int8']) for _ in range(3))}]")
    before = "\n".join([*arrays, INNER, *(law(draw, name) for name in laws)])
    leaves, instances, arrows, order = [], [], [], []
    for number in range(draw.randint(1, 2)):
        unit = Unit(draw, laws=len(laws))
        steps = [unit.step(2) for _ in range(draw.randint(3, 6))]
        for position in range(len(laws)):
            run = Node(f"((law{position} ; o ! of_law) catch Fault -> o ! {unit.fresh() + 1000})")
            steps.insert(draw.randint(0, len(steps)), run)
        body = Node("", tuple(steps), " ; ")
        variables = [f"    var v_{kind} : {kind} = {initial}" for kind, initial in INITIAL.items()]
        inside = []
        for position, name in enumerate(laws):
            given = ", ".join([*PARAMETERS, "given"]) if draw.random() < 0.5 else _arguments(draw)
            inside += [f"    law{position} : {name}({given})", f"    v_int -> law{position}.u"]
        inside.append(f"    {', '.join(f'law{position}.y' for position in range(len(laws)))} -> of_law")
        declared = [
            "  out o : int", "  communication {", *variables, "    var of_law : int = 0",
            "    var own : int[3] = [5, 6, 7]",
            "    var open : bool[3] = [true, false, true]", *inside, "  }",
        ]  # fmt: skip
        leaves.append((f"Unit{number}({DECLARED})", "\n".join(declared), body))
        copies = [f"unit{number}_{copy}" for copy in range(draw.randint(1, 3))]
        instances += [f"    {copy} : Unit{number}({_arguments(draw)})" for copy in copies]
        arrows.append(f"    {', '.join(f'{copy}.o' for copy in copies)} -> o{number}")
        order.append(Node("", tuple(Node(f"({copy} catch Fault -> skip)") for copy in copies), " ; "))
    ports = [f"  out o{number} : int" for number in range(len(leaves))]
    after = [
        "process Top {", *ports, "  communication {", *instances, *arrows, "  }", "  composition { {top} }", "}",
        "environment Bench for Top {", *(f"  o{number} -> _" for number in range(len(leaves))), "}", "",
    ]  # fmt: skip
    return Program(before, tuple(leaves), "\n".join(after), Node("", tuple(order), " || "))
