"""Random programs of processes that meet: short compositions over all kinds of channels that communicate often.

They nest what ``tests.properties`` seldom nests: interrupts in interrupts, parallels in alternatives in loops, handlers
that fault, ends that nothing uses. A program is drawn from ``random.Random``: the same one for the same seed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from random import Random

from tests.conformance.random.nodes import Node, Program
from tests.conformance.random.plants import plant
from tests.properties.vocabulary import DEFINITIONS, FORMS, INITIAL, LITERALS, PRESENT

KINDS = ("sync",) * 6 + ("any",) * 4 + ("buffer 1", "buffer 2", "overwrite 1", "overwrite 2", "broadcast", "broadcast")
TYPES = ("int",) * 8 + tuple(sorted(INITIAL))
DELAYS = ("1 ms", "1 ms", "2 ms", "2 ms", "3 ms", "0 ms", "500 us", "3 ms - now", "now % 2 ms")
INSTANTS = ("0 ms", "1 ms", "3 ms", "4500 us", "now", "now + 1 ms", "now + 2 ms - now % 2 ms", "3 * now")

LAWS = """submodel Sums {
  in  u : int
  out y : int

  state total : int = 0
  next total = (total + u) % 1000
  y = total + u % 1000
}

submodel Counts {
  out y : int

  state n : int = 0
  next n = (n + 1) % 100
  y = n
}
"""

EXTERNAL = {
    "y": ("in", "double", " @ 1 ms"),
    "z": ("in", "double", " @ 2 ms"),
    "press": ("in", "int", ""),
    "turn": ("in", "int", ""),
    "u": ("out", "double", " @ 1 ms"),
    "count": ("out", "int", ""),
}


OFFSETS = (" offset 300 us", " offset 500 us", "")


def external_ports(seed: int) -> dict[str, tuple[str, str, str]]:
    """The external ports, in half of the programs some with an offset, which is drawn separately."""
    draw = Random(f"offsets {seed}")
    if draw.random() < 0.5:
        return EXTERNAL
    return {
        name: (way, kind, period and period + draw.choice(OFFSETS)) for name, (way, kind, period) in EXTERNAL.items()
    }


@dataclass
class Leaf:
    """A process under construction."""

    name: str
    ports: dict[str, tuple[str, str]] = field(default_factory=dict)
    """Direction and type of each port."""
    shared: set[str] = field(default_factory=set)
    """Ports that parallel parts may use at once."""
    periods: dict[str, str] = field(default_factory=dict)
    variables: dict[str, tuple[str, str]] = field(default_factory=dict)
    laws: list[str] = field(default_factory=list)
    """Control laws and the variables that they are connected to."""
    indexes: list[str] = field(default_factory=list)
    """Indexes of the replicators around what is being drawn."""
    numbers: int = 0

    def fresh(self, stem: str) -> str:
        """A name that is not used yet."""
        self.numbers += 1
        return f"{stem}{self.numbers}"

    def declared(self) -> str:
        """Ports and variables."""
        ports = [f"  {way} {name} : {kind}{self.periods.get(name, '')}" for name, (way, kind) in self.ports.items()]
        variables = [f"    var {name} : {kind} = {initial}" for name, (kind, initial) in self.variables.items()]
        return "\n".join([*ports, "  communication {", *variables, *self.laws, "  }"])


@dataclass
class Part:
    """What a part of a composition may use."""

    draw: Random
    leaf: Leaf
    ports: list[str]
    suffix: str = ""

    def variable(self, kind: str) -> str:
        """The variable of a type."""
        name = f"v_{kind.replace('[3]', 's')}{self.suffix}"
        self.leaf.variables[name] = (kind, INITIAL[kind])
        return name

    def literal(self, kind: str) -> str:
        """A literal, a constant or a variable."""
        variable = self.variable(kind)
        indexes = self.leaf.indexes if kind == "int" else []
        if indexes and self.draw.random() < 0.7:
            return f"({' + 10 * '.join(indexes)})"
        return self.draw.choice([*LITERALS[kind], *PRESENT.get(kind, ()), variable, variable])

    def value(self, kind: str, depth: int = 1) -> str:
        """An expression."""
        if depth == 0 or self.draw.random() < 0.6:
            return self.literal(kind)
        form, kinds = self.draw.choice(FORMS[kind])
        inner = [self.value(k, depth - 1) for k in kinds]
        if not form.startswith("(if"):
            inner[0] = self.variable(kinds[0])
        if form[4:5] in ("/", "%", "^"):
            inner[1:] = [self.variable(k) for k in kinds[1:]]
        return form.format(*inner)

    def others(self, *gone: str) -> Part:
        """The same part without some ports."""
        return Part(self.draw, self.leaf, [p for p in self.ports if p not in gone], self.suffix)

    def split(self, count: int) -> list[Part]:
        """The parts that parallel branches may use."""
        parts = [Part(self.draw, self.leaf, [], self.leaf.fresh("_")) for _ in range(count)]
        for port in self.ports:
            for part in parts if port in self.leaf.shared else [self.draw.choice(parts)]:
                part.ports.append(port)
        return parts


def access(part: Part, port: str) -> str:
    """A reader or a writer."""
    way, kind = part.leaf.ports[port]
    return f"{port} ? {part.variable(kind)}" if way == "in" else f"{port} ! {part.value(kind)}"


def guard(part: Part, free: list[str], *, watching: bool = False) -> tuple[str, str]:
    """A guard, and what the guarded process begins with."""
    draw = part.draw
    condition = f"when {part.value('bool')} & " if draw.random() < 0.12 else ""
    if not watching and draw.random() < 0.05:
        return f"{condition}skip", ""
    if not free or draw.random() < 0.2:
        timed = f"at {draw.choice(INSTANTS)}" if draw.random() < 0.25 else f"after {draw.choice(DELAYS)}"
        return f"{condition}{timed}", ""
    port = draw.choice(free)
    if draw.random() < 0.9:
        free.remove(port)
    if part.leaf.ports[port][0] == "in" and draw.random() < 0.15:
        return condition + port, f"{access(part, port)} ; "
    return condition + access(part, port), ""


def guarded(part: Part, free: list[str], depth: int) -> Node:
    """A guarded process."""
    text, first = guard(part, free)
    return Node(f"({plain(text)} -> ({plain(first)}{{}}))", (step(part, depth),), guarded=True)


def law(part: Part) -> str:
    """A control law between variables that is used only there; one of them may be both read and written by it."""
    leaf, name, variable = part.leaf, part.leaf.fresh("law"), part.variable("int")
    if part.draw.random() < 0.3:
        leaf.laws.append(f"    {name} : Counts  {name}.y -> {variable}")
    else:
        leaf.laws.append(f"    {name} : Sums  {variable} -> {name}.u  {name}.y -> {variable}")
    return name


COMPOSED = (
    ("seq",) * 4 + ("par",) * 4 + ("alt",) * 5 + ("interrupt",) * 6 + ("mu",) * 2 + ("catch",) * 2
    + ("if", "raise", "while", "seq i", "seq i", "group")
)  # fmt: skip


def plain(text: str) -> str:
    """The text of a form."""
    return text.replace("{", "{{").replace("}", "}}")


def step(part: Part, depth: int) -> Node:
    """A composition."""
    draw = part.draw
    if depth == 0 or draw.random() < 0.25:
        choice = draw.random()
        if choice < 0.75 and part.ports:
            return Node(f"({plain(access(part, draw.choice(part.ports)))})")
        if choice < 0.87 and part.leaf.indexes and draw.random() < 0.5:
            return Node(f"(wait {draw.choice(part.leaf.indexes)} % 5 * 100 us)")
        if choice < 0.87:
            return Node(
                f"(wait until {draw.choice(INSTANTS)})" if draw.random() < 0.2 else f"(wait {draw.choice(DELAYS)})"
            )
        if choice < 0.9:
            return Node(law(part))
        if choice < 0.95:
            kind = draw.choice(sorted(INITIAL))
            return Node(f"({part.variable(kind)} := {plain(part.value(kind, 2))})")
        return Node(draw.choice(["skip", "skip", "skip", "stop"]))
    return composed(part, draw.choice(COMPOSED), depth)


def composed(part: Part, kind: str, depth: int) -> Node:
    """A composition of compositions."""
    draw = part.draw
    match kind:
        case "seq":
            return Node("", tuple(step(part, depth - 1) for _ in range(draw.randint(2, 3))), " ; ")
        case "par":
            parts = part.split(draw.randint(2, 3))
            return Node("", tuple(step(p, depth - 1) for p in parts), draw.choice([" || ", " || ", " ||> "]))
        case "alt":
            free = list(part.ports)
            branches = tuple(guarded(part, free, depth - 1) for _ in range(draw.randint(2, 3)))
            return Node("", branches, draw.choice([" [] ", " []> "]))
        case "mu":
            return _counted(part, "({0} := 0 ; (mu ({{}} ; {0} := {0} + 1) until {0} >= {1}))", depth)
        case "while":
            return _counted(part, "({0} := 0 ; (while {0} < {1} do ({{}} ; {0} := {0} + 1)))", depth)
        case "seq i":
            return _replicated(part, depth)
        case "if":
            form = f"(if {plain(part.value('bool'))} then {{}} else {{}})"
            return Node(form, (step(part, depth - 1), step(part, depth - 1)))
        case "raise":
            return Node(f"(if {plain(part.value('bool'))} then raise {draw.choice(['Overheated', 'Jammed'])})")
        case "catch":
            name = draw.choice(["Overheated", "Fault", "Fault", "Timeout"])
            return Node(f"({{}} catch {name} -> {{}})", (step(part, depth - 1), step(part, depth - 1)))
        case "interrupt":
            return _interrupted(part, depth)
        case _:
            return Node(f"({part.leaf.fresh('group')}: {{}})", (step(part, depth - 1),))


def _counted(part: Part, form: str, depth: int) -> Node:
    counter = part.leaf.fresh("k")
    part.leaf.variables[counter] = ("int", "0")
    return Node(form.format(counter, part.draw.randint(2, 3)), (step(part, depth - 1),))


def _replicated(part: Part, depth: int) -> Node:
    """A replicated sequence whose index may be used inside, with many iterations only if it is outermost; often one in
    another.
    """
    draw, indexes = part.draw, part.leaf.indexes
    index = part.leaf.fresh("each")
    turns = draw.choice((2, 3, 3, 20, 70)) if not indexes else draw.choice((2, 3, 3, 4))
    indexes.append(index)
    body = _replicated(part, depth - 1) if depth > 1 and draw.random() < 0.3 else step(part, depth - 1)
    indexes.pop()
    return Node(f"(seq {index} < {turns} : {{}})", (body,))


def _interrupted(part: Part, depth: int) -> Node:
    """A body that is interrupted through ports that it does not use itself."""
    own = [p for p in part.ports if p in part.leaf.shared or part.draw.random() < 0.4]
    watching = Part(part.draw, part.leaf, list(own), part.leaf.fresh("_"))
    text, first = guard(watching, list(own), watching=True)
    taken = [p for p in own if p not in part.leaf.shared]
    body = step(part.others(*taken), depth - 1)
    return Node(f"({{}} interrupt {plain(text)} -> ({plain(first)}{{}}))", (body, step(part, depth - 1)))


def connected(draw: Random, leaves: Sequence[Leaf]) -> list[str]:
    """Channels between the leaves."""
    relations = []
    for number in range(draw.randint(2, 5)):
        kind, shape = draw.choice(TYPES), draw.choice(KINDS)
        order = draw.sample(range(len(leaves)), len(leaves))
        writers = draw.randint(1, len(leaves) - 1) if shape == "any" else 1
        readers = draw.randint(1, len(leaves) - writers) if shape in ("any", "broadcast") else 1
        for index in order[:writers]:
            leaves[index].ports[f"o{number}"] = ("out", kind)
        for index in order[writers : writers + readers]:
            leaves[index].ports[f"i{number}"] = ("in", kind)
        if shape == "any":
            for index in order[: writers + readers]:
                leaves[index].shared |= {f"o{number}", f"i{number}"} & set(leaves[index].ports)
        sources = ", ".join(f"leaf{i}.o{number}" for i in order[:writers])
        sinks = ", ".join(f"leaf{i}.i{number}" for i in order[writers : writers + readers])
        relations.append(f"{sources} -> c{number} : {kind} {shape} -> {sinks}")
    return relations


def outside(draw: Random, leaves: Sequence[Leaf], external: Mapping[str, tuple[str, str, str]]) -> list[str]:
    relations = []
    for name, (way, kind, period) in external.items():
        several = way == "in" and draw.random() < 0.5
        chosen = draw.sample(range(len(leaves)), draw.randint(1, 2) if several else 1)
        for index in chosen:
            leaves[index].ports[name] = (way, kind)
            if period:
                leaves[index].periods[name] = period
                if way == "in":
                    leaves[index].shared.add(name)
        inner = ", ".join(f"leaf{i}.{name}" for i in chosen)
        middle = " -> " + draw.choice(["broadcast", "any"]) if len(chosen) > 1 and not period else ""
        relations.append(f"{name}{middle} -> {inner}" if way == "in" else f"{inner} -> {name}")
    return relations


DEEP = (
    "({0} := 0 ; (mu ({{}} ; {0} := {0} + 1) until {0} >= 1))",
    "({0} := 0 ; (while {0} < 1 do ({{}} ; {0} := {0} + 1)))",
    "({{}} catch Jammed -> ({0} := -1))",
    "(if {0} < 100 then {{}} else skip)",
    "(group{0}: {{}})",
    "(seq each{0} < 1 : {{}})",
    "({{}} interrupt after 2 s -> ({0} := -2))",
    "((skip -> {{}}) []> (after 1 ms -> ({0} := -3)))",
)
"""Forms around a composition that runs once inside them; each has a counter of its own."""


def _deep(draw: Random, leaf: Leaf, inner: Node) -> Node:
    """A composition nested more deeply than Python allows in one function."""
    for _ in range(draw.randint(15, 60)):
        counter = leaf.fresh("deep")
        leaf.variables[counter] = ("int", "0")
        inner = Node(draw.choice(DEEP).format(counter), (inner,))
    return inner


def meetings(seed: int) -> Program:
    """The program of a seed."""
    draw, external = Random(seed), external_ports(seed)
    deep = Random(f"deep {seed}")
    leaves = [Leaf(f"Leaf{i}") for i in range(draw.randint(2, 4))]
    relations = [*connected(draw, leaves), *outside(draw, leaves, external)]
    bodies = []
    for leaf in leaves:
        counter = leaf.fresh("k")
        leaf.variables[counter] = ("int", "0")
        part = Part(draw, leaf, list(leaf.ports))
        inner = Node("", tuple(step(part, draw.choice([1, 2, 3, 3])) for _ in range(draw.randint(1, 3))), " ; ")
        rounds = f"(mu ({{}} ; {counter} := {counter} + 1) until {counter} >= {draw.randint(2, 4)})"
        body = Node(rounds, (inner,))
        bodies.append(_deep(deep, leaf, body) if deep.random() < 0.03 else body)
    return assembled(draw, leaves, bodies, relations, external, plant(seed))


def assembled(
    draw: Random,
    leaves: Sequence[Leaf],
    bodies: Sequence[Node],
    relations: Sequence[str],
    external: Mapping[str, tuple[str, str, str]],
    plant: str,
) -> Program:
    """The program of some leaves in parallel, with an environment."""
    operator = draw.choice([" || ", " || ", " ||> "])
    top = Node("", tuple(Node(f"leaf{i}") for i in draw.sample(range(len(leaves)), len(leaves))), operator)
    ports = [f"  {way} {name} : {kind}{period}" for name, (way, kind, period) in external.items()]
    after = [
        "process Top {", *ports, "  communication {",
        *(f"    leaf{i} : {leaf.name}" for i, leaf in enumerate(leaves)), *(f"    {r}" for r in relations), "  }",
        "  composition { {top} }", "}", f"environment Bench for Top{draw.choice(['', '', ' on miss count'])} {{",
        "  plant : Plant",
        *(f"  plant.{n} -> {n}" if way == "in" else f"  {n} -> plant.{n}" for n, (way, *_) in EXTERNAL.items()), "}",
        "",
    ]  # fmt: skip
    definitions = tuple((leaf.name, leaf.declared(), body) for leaf, body in zip(leaves, bodies, strict=True))
    return Program(f"{DEFINITIONS}\n{plant}\n{LAWS}", definitions, "\n".join(after), top)
