"""Random programs whose processes meet in every way that the language knows, as text.

Leaf processes run compositions that are drawn as trees, over channels of all kinds and ports of several rates. What a part of a composition may use is
split among parallel branches, so that every program is well-typed and free of races; it may well deadlock, miss samples, overflow, or be
interrupted in the middle of anything.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from hypothesis import strategies as st

INITIAL = {
    "int": "2", "int8": "int8(3)", "double": "1.5", "float": "float(0.5)", "bool": "false",
    "Pose": "Pose(x = 0.0, n = 1)", "int[3]": "[1, 2, 3]",
}  # fmt: skip

DEFINITIONS = """exception Overheated

exception Jammed

struct Pose {
  x : double
  n : int
}

submodel Single {
  in  a : double
  out p : double

  state s : double = 0
  next s = 0.5 * s + a
  p = s + a
}

submodel Double {
  in  a, b : double
  out p, q : double

  state s : double = 1
  next s = limit(s - a, -9, 9)
  p = s + b
  q = 0.5 * a
}

submodel Plant {
  in  u1, u2, shown : double
  in  counted       : int
  out y1, y2, y3    : double
  out press, turn   : int

  state x : double = 1
  state n : int    = 0
  state k : int    = 0
  der x = u1 - 0.5 * u2 - x
  next n = n + 1
  next k = (if counted > 5 then 0 else k + 1)
  y1    = x
  y2    = x + 0.1 * shown
  y3    = 2 * x
  press = n / 4
  turn  = (n + k) / 7 + counted / 3
}
"""

EXTERNAL = {
    "y1": ("in", "double", "@ 1 ms"),
    "y2": ("in", "double", "@ 2 ms"),
    "y3": ("in", "double", "@ 1 ms"),
    "press": ("in", "int", ""),
    "turn": ("in", "int", ""),
    "u1": ("out", "double", "@ 1 ms"),
    "u2": ("out", "double", "@ 3 ms immediate"),
    "shown": ("out", "double", "@ 2 ms"),
    "counted": ("out", "int", ""),
}


@dataclass
class Leaf:
    """A leaf process under construction."""

    name: str
    ports: dict[str, tuple[str, str]] = field(default_factory=dict)
    """Direction and type of each port."""
    periods: dict[str, str] = field(default_factory=dict)
    instances: list[str] = field(default_factory=list)
    variables: dict[str, tuple[str, str]] = field(default_factory=dict)
    """Type and initial value of each variable."""
    numbers: int = 0
    laws: dict[str, tuple[str, str | None]] = field(default_factory=dict)
    """Submodel instances, with an input that may be their guard."""

    def fresh(self, stem: str) -> str:
        """A name that nothing else has."""
        self.numbers += 1
        return f"{stem}{self.numbers}"


@dataclass
class Part:
    """What a part of a composition may use: ports, submodels and a set of variables of its own."""

    leaf: Leaf
    ports: list[str]
    laws: list[str]
    suffix: str
    used: set[str]

    def variable(self, kind: str) -> str:
        """The variable of a type."""
        name = f"v_{kind.replace('[3]', 's')}{self.suffix}"
        self.leaf.variables[name] = (kind, INITIAL[kind])
        return name

    def without(self, *ports: str) -> Part:
        """The same without some ports."""
        return Part(self.leaf, [p for p in self.ports if p not in ports], self.laws, self.suffix, self.used)


def literal(draw: st.DrawFn, part: Part, kind: str) -> str:
    """A literal or a variable."""
    literals = {
        "int": ["0", "1", "7", "-3"],
        "int8": ["int8(100)", "int8(-3)"],
        "double": ["0.5", "1.25", "-2.0"],
        "float": ["float(0.1)", "float(3.5)"],
        "bool": ["true", "false"],
        "Pose": ["Pose(x = 0.5, n = 2)"],
        "int[3]": ["[0, 1, 5]"],
    }
    return draw(st.sampled_from([*literals[kind], part.variable(kind), part.variable(kind)]))


FORMS: dict[str, list[tuple[str, tuple[str, ...]]]] = {
    "int": [
        ("({} + {})", ("int", "int")), ("({} * {})", ("int", "int")), ("({} / {})", ("int", "int")),
        ("({} % {})", ("int", "int")), ("int({})", ("int8",)), ("{}.n", ("Pose",)), ("{}[1]", ("int[3]",)),
        ("int({})", ("double",)), ("(-{})", ("int",)),
    ],
    "int8": [("int8({})", ("int",)), ("({} + {})", ("int8", "int8")), ("({} * {})", ("int8", "int8"))],
    "double": [
        ("({} + {})", ("double", "double")), ("({} * {})", ("double", "double")), ("({} / {})", ("double", "double")),
        ("double({})", ("int",)), ("{}.x", ("Pose",)), ("double({})", ("float",)), ("sqrt({})", ("double",)),
        ("limit({}, -10.0, 10.0)", ("double",)),
    ],
    "float": [("({} + {})", ("float", "float")), ("({} * {})", ("float", "float")), ("float({})", ("double",))],
    "bool": [
        ("({} < {})", ("int", "int")), ("({} == {})", ("int8", "int8")), ("({} >= {})", ("double", "double")),
        ("({} and {})", ("bool", "bool")), ("(not {})", ("bool",)), ("({} > {})", ("float", "float")),
    ],
    "Pose": [("Pose(x = {}, n = {})", ("double", "int")), ("(if {} then {} else {})", ("bool", "Pose", "Pose"))],
    "int[3]": [("[{}, {}, {}]", ("int", "int", "int"))],
}  # fmt: skip


def value(draw: st.DrawFn, part: Part, kind: str, depth: int = 2) -> str:
    """An expression of a type; what can fault is rare, and sometimes does."""
    if depth == 0 or draw(st.integers(0, 2)) > 0:
        return literal(draw, part, kind)
    form, kinds = draw(st.sampled_from(FORMS[kind]))
    inner = [value(draw, part, k, depth - 1) for k in kinds]
    if form[0] == "{" or kind == "int8":
        # A member is taken of a variable; and a constant that is out of range would be refused.
        inner[0] = part.variable(kinds[0])
    if form[4:5] in ("/", "%"):
        inner[1] = part.variable(kinds[1])
    return form.format(*inner)


def access(draw: st.DrawFn, part: Part, port: str) -> str:
    """A reader or a writer."""
    part.used.add(port)
    direction, kind = part.leaf.ports[port]
    if direction == "in":
        return f"{port} ? {part.variable(kind)}"
    return f"{port} ! {value(draw, part, kind)}"


DELAYS = ("0 ms", "1 ms", "2 ms", "3 ms", "300 us", "1500 us", "7 ms")


def guard(draw: st.DrawFn, part: Part, free: list[str]) -> tuple[str, str | None]:
    """A guard, and what the guarded process has to begin with; takes the port that it uses out of ``free``."""
    condition = f"when {value(draw, part, 'bool', 1)} & " if draw(st.integers(0, 3)) == 0 else ""
    choice = draw(st.integers(0, 7)) if free else 7
    if choice == 7:
        return condition + draw(st.sampled_from([f"after {d}" for d in DELAYS])), None
    port = draw(st.sampled_from(free))
    free.remove(port)
    if choice <= 1 and part.leaf.ports[port][0] == "in":
        return condition + port, access(draw, part, port)
    return condition + access(draw, part, port), None


def guarded(draw: st.DrawFn, part: Part, free: list[str], depth: int) -> str:
    """A guarded process."""
    text, first = guard(draw, part, free)
    rest = step(draw, part, depth)
    return f"({text} -> ({first} ; {rest}))" if first else f"({text} -> {rest})"


def split(draw: st.DrawFn, part: Part, count: int) -> list[Part]:
    """The parts of parallel branches; sampled inputs may be read by all of them."""
    shared = [p for p in part.ports if p in part.leaf.periods and part.leaf.ports[p][0] == "in"]
    parts = [Part(part.leaf, list(shared), [], part.leaf.fresh("_"), part.used) for _ in range(count)]
    for port in part.ports:
        if port not in shared:
            draw(st.sampled_from(parts)).ports.append(port)
    for law in part.laws:
        draw(st.sampled_from(parts)).laws.append(law)
    return parts


def step(draw: st.DrawFn, part: Part, depth: int) -> str:
    """A composition, as an operand."""
    kinds = ["access"] * 4 * bool(part.ports) + ["law"] * 2 * bool(part.laws) + ["assign", "wait", "skip"]
    if depth > 0:
        kinds += [
            "seq",
            "seq",
            "par",
            "alt",
            "alt",
            "mu",
            "while",
            "if",
            "catch",
            "interrupt",
            "interrupt",
            "group",
            "raise",
        ]
    kind = draw(st.sampled_from(kinds))
    match kind:
        case "access":
            return f"({access(draw, part, draw(st.sampled_from(part.ports)))})"
        case "law":
            return run_law(draw, part, draw(st.sampled_from(part.laws)))
        case "assign":
            return assignment(draw, part)
        case "wait":
            return f"(wait {draw(st.sampled_from(DELAYS))})"
        case "skip":
            return draw(st.sampled_from(["skip", "skip", "stop"]))
        case "seq":
            return f"({' ; '.join(step(draw, part, depth - 1) for _ in range(draw(st.integers(2, 4))))})"
        case "par":
            operator = draw(st.sampled_from([" || ", " ||> "]))
            return f"({operator.join(step(draw, p, depth - 1) for p in split(draw, part, draw(st.integers(2, 3))))})"
        case "alt":
            operator = draw(st.sampled_from([" [] ", " []> "]))
            free = list(part.ports)
            return f"({operator.join(guarded(draw, part, free, depth - 1) for _ in range(draw(st.integers(2, 4))))})"
        case "mu" | "while":
            return loop(draw, part, kind, depth)
        case "if":
            parts = [step(draw, part, depth - 1) for _ in range(2)]
            return f"(if {value(draw, part, 'bool')} then {parts[0]} else {parts[1]})"
        case "raise":
            return f"(if {value(draw, part, 'bool')} then raise {draw(st.sampled_from(['Overheated', 'Jammed']))})"
        case "catch":
            name = draw(st.sampled_from(["Overheated", "Jammed", "Fault", "Timeout"]))
            return f"({step(draw, part, depth - 1)} catch {name} -> {step(draw, part, depth - 1)})"
        case "interrupt":
            return interrupted(draw, part, depth)
        case _:
            return f"({part.leaf.fresh('group')}: {step(draw, part, depth - 1)})"


def run_law(draw: st.DrawFn, part: Part, law: str) -> str:
    """A run of a submodel, perhaps guarded."""
    part.used.add(law)
    guard_port = part.leaf.laws[law][1]
    forms = [f"({law})", f"({law} ; reset {law})"] + ([f"({guard_port} -> {law})"] if guard_port else [])
    return draw(st.sampled_from(forms))


def assignment(draw: st.DrawFn, part: Part) -> str:
    """An assignment, to an element sometimes."""
    kind = draw(st.sampled_from(sorted(INITIAL)))
    if kind == "int[3]" and draw(st.booleans()):
        return f"({part.variable(kind)}[{literal(draw, part, 'int')}] := {value(draw, part, 'int')})"
    return f"({part.variable(kind)} := {value(draw, part, kind)})"


def loop(draw: st.DrawFn, part: Part, kind: str, depth: int) -> str:
    """A loop that lets time pass or ends."""
    counter = part.leaf.fresh("k")
    part.leaf.variables[counter] = ("int", "0")
    count = draw(st.integers(1, 4))
    condition = value(draw, part, "bool", 1)
    body = f"({step(draw, part, depth - 1)} ; {counter} := {counter} + 1)"
    if kind == "while":
        return f"({counter} := 0 ; (while {counter} < {count} and ({condition} or true) do {body}))"
    return f"({counter} := 0 ; (mu {body} until {counter} >= {count} or {condition}))"


def interrupted(draw: st.DrawFn, part: Part, depth: int) -> str:
    """A body that is interrupted through a port that it does not use itself, or after a while."""
    inputs = [p for p in part.ports if draw(st.booleans())]
    free = list(inputs[:1])
    watching = Part(part.leaf, free, [], part.leaf.fresh("_"), part.used)
    text, first = guard(draw, watching, free)
    body = step(draw, part.without(*inputs[:1]), depth - 1)
    handler = step(draw, part, depth - 1)
    return f"({body} interrupt {text} -> {f'({first} ; {handler})' if first else handler})"


def leaf_text(draw: st.DrawFn, leaf: Leaf) -> str:
    """The definition of a leaf process."""
    doubles = [p for p, (direction, kind) in leaf.ports.items() if kind == "double" and direction == "in"]
    outs = [p for p, (direction, kind) in leaf.ports.items() if kind == "double" and direction == "out"]
    arrows = []
    if doubles and outs and draw(st.booleans()):
        outs = [p for p in outs if leaf.periods.get(p, leaf.periods.get(doubles[0])) == leaf.periods.get(doubles[0])]
        doubles = [p for p in doubles if leaf.periods.get(p) == leaf.periods.get(doubles[0])]
        two = len(doubles) > 1 and draw(st.booleans())
        name = leaf.fresh("law")
        leaf.laws[name] = ("Double" if two else "Single", None if two else doubles[0])
        inputs = doubles[: 2 if two else 1]
        outputs = [*outs, "_", "_"][: 2 if two else 1]
        arrows += [f"{port} -> {name}.{end}" for port, end in zip(inputs, "ab", strict=False)]
        arrows += [f"{name}.{end} -> {port}" for port, end in zip(outputs, "pq", strict=False)]
    reserved = {"_"} | {arrow.partition(" ")[0] for arrow in arrows} | {arrow.rpartition(" ")[2] for arrow in arrows}
    part = Part(leaf, [p for p in leaf.ports if p not in reserved], list(leaf.laws), "", set())
    steps = [step(draw, part, draw(st.integers(1, 3))) for _ in range(draw(st.integers(1, 3)))]
    steps += [f"({access(draw, part, port)})" for port in part.ports if port not in part.used]
    steps += [f"({law})" for law in part.laws if law not in part.used]
    body = " ; ".join(draw(st.permutations(steps))) + " ; skip"
    ports = [
        f"  {direction} {name} : {kind} {leaf.periods.get(name, '')}".rstrip()
        for name, (direction, kind) in leaf.ports.items()
    ]
    variables = [f"    var {name} : {kind} = {initial}" for name, (kind, initial) in leaf.variables.items()]
    laws = [f"    {name} : {definition}" for name, (definition, _) in leaf.laws.items()]
    return "\n".join(
        [
            f"process {leaf.name} {{", *ports, "  communication {", *variables, *laws,
            *(f"    {arrow}" for arrow in arrows), "  }", "  composition {", f"    {body}", "  }", "}", "",
        ]
    )  # fmt: skip


def connect(draw: st.DrawFn, leaves: Sequence[Leaf]) -> list[str]:
    """Channels between leaves; the relationships."""
    relations = []
    for number in range(draw(st.integers(1, 5))):
        kind = draw(st.sampled_from(sorted(INITIAL)))
        kind = draw(st.sampled_from([kind, "int", "double"]))
        shape = draw(st.sampled_from(["sync", "sync", "buffer 2", "buffer 1", "overwrite 2", "any", "broadcast"]))
        order = list(draw(st.permutations(range(len(leaves)))))
        readers = writers = 1
        if shape == "any" and len(leaves) > 2:
            writers, readers = draw(st.sampled_from([(2, 1), (1, 2)] + [(2, 2)] * (len(leaves) > 3)))
        if shape == "broadcast":
            readers = draw(st.integers(1, len(leaves) - 1))
        sources, sinks = order[:writers], order[writers : writers + readers]
        for index in sources:
            leaves[index].ports[f"o{number}"] = ("out", kind)
        for index in sinks:
            leaves[index].ports[f"i{number}"] = ("in", kind)
        asked = "" if shape == "sync" or (shape in ("any", "broadcast") and writers == readers == 1) else f" {shape}"
        left = ", ".join(f"leaf{i}.o{number}" for i in sources)
        right = ", ".join(f"leaf{i}.i{number}" for i in sinks)
        relations.append(f"{left} -> c{number} : {kind}{asked} -> {right}")
    for name, (direction, kind, period) in EXTERNAL.items():
        shared = name in ("y1", "y2", "y3") or name == "turn"
        count = draw(st.integers(1, 2)) if shared else 1
        chosen = list(draw(st.permutations(range(len(leaves)))))[:count]
        for index in chosen:
            leaves[index].ports[name] = (direction, kind)
            if period:
                leaves[index].periods[name] = period.removesuffix(" immediate")
        inner = ", ".join(f"leaf{i}.{name}" for i in chosen)
        asked = draw(st.sampled_from(["broadcast -> ", "any -> "])) if name == "turn" and count == 2 else ""
        relations.append(f"{name} -> {asked}{inner}" if direction == "in" else f"{inner} -> {name}")
    return relations


def running(draw: st.DrawFn, count: int) -> str:
    """The composition of the outermost process: leaves in parallel, some of them more than once."""
    names = []
    for index in draw(st.permutations(range(count))):
        form = draw(st.sampled_from(["{0}", "{0}", "{0}", "({0} ; {0})", "(par i < 1 : {0})", "(seq i < 2 : {0})"]))
        names.append(form.format(f"leaf{index}"))
    operator = draw(st.sampled_from([" || ", " || ", " ||> "]))
    if len(names) > 2 and draw(st.booleans()):
        inner = " ||> " if operator == " || " else " || "
        return f"({inner.join(names[:2])}){operator}{operator.join(names[2:])}"
    return operator.join(names)


@st.composite
def encounters(draw: st.DrawFn) -> str:
    """A whole program with its environment ``Bench``."""
    leaves = [Leaf(f"Leaf{i}") for i in range(draw(st.integers(2, 4)))]
    relations = connect(draw, leaves)
    definitions = "\n".join(leaf_text(draw, leaf) for leaf in leaves)
    ports = [f"  {direction} {name} : {kind} {period}".rstrip() for name, (direction, kind, period) in EXTERNAL.items()]
    top = [
        "process Top {", *ports, "  communication {", *(f"    leaf{i} : Leaf{i}" for i in range(len(leaves))),
        *(f"    {relation}" for relation in relations), "  }",
        "  composition {", f"    {running(draw, len(leaves))}", "  }", "}", "",
    ]  # fmt: skip
    step_ = draw(st.sampled_from(["1 ms", "500 us", "2 ms", "1500 us"]))
    miss = draw(st.sampled_from(["", " on miss count"]))
    wires = [
        f"  plant.{name} -> {name}" if direction == "in" else f"  {name} -> plant.{name}"
        for name, (direction, _, _) in EXTERNAL.items()
    ]
    environment = [f"environment Bench for Top step {step_}{miss} {{", "  plant : Plant", *wires, "}", ""]
    return "\n".join([DEFINITIONS, definitions, *top, *environment])
