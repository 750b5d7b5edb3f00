"""Random processes: compositions drawn as trees, over whatever ports, control laws and inner processes they are given.

What a part of a composition may use is split among parallel branches, so that every process is well-typed and free of
races.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from hypothesis import strategies as st

from tests.properties.laws import LAWS
from tests.properties.vocabulary import INITIAL, LITERALS, literal, value


@dataclass
class Leaf:
    """A process under construction."""

    name: str
    ports: dict[str, tuple[str, str]] = field(default_factory=dict)
    """Direction and type of each port."""
    periods: dict[str, str] = field(default_factory=dict)
    parameters: dict[str, str] = field(default_factory=dict)
    """Type of each parameter."""
    variables: dict[str, tuple[str, str]] = field(default_factory=dict)
    """Type and initial value of each variable."""
    numbers: int = 0
    instances: dict[str, str] = field(default_factory=dict)
    """The definition, with arguments, of each instance inside."""
    units: dict[str, tuple[str, ...]] = field(default_factory=dict)
    """What can be run: a control law with the input that may be its guard, or processes that share their ports and so
    run one after the other.
    """
    definitions: list[str] = field(default_factory=list)
    """Processes inside, before it in the text."""
    arrows: list[str] = field(default_factory=list)
    alone: set[str] = field(default_factory=set)
    """Ports that one process at most may read: ends of a broadcast."""
    defaults: dict[str, str] = field(default_factory=dict)
    """Inputs that are connected to nothing, with their values."""

    def fresh(self, stem: str) -> str:
        """A name that is not used yet."""
        self.numbers += 1
        return f"{stem}{self.numbers}"


@dataclass
class Part:
    """What a part of a composition may use: ports, units and a set of variables of its own."""

    leaf: Leaf
    ports: list[str]
    units: list[str]
    suffix: str
    used: set[str]

    def variable(self, kind: str) -> str:
        """The variable of a type."""
        name = f"v_{kind.replace('[3]', 's')}{self.suffix}"
        self.leaf.variables[name] = (kind, INITIAL[kind])
        return name

    def constants(self, kind: str) -> list[str]:
        """Parameters of a type."""
        return [name for name, type_ in self.leaf.parameters.items() if type_ == kind]

    def without(self, *ports: str) -> Part:
        """The same part without some ports."""
        return Part(self.leaf, [p for p in self.ports if p not in ports], self.units, self.suffix, self.used)


def access(draw: st.DrawFn, part: Part, port: str) -> str:
    """A reader or a writer."""
    part.used.add(port)
    direction, kind = part.leaf.ports[port]
    if direction == "in":
        return f"{port} ? {part.variable(kind)}"
    return f"{port} ! {value(draw, part, kind)}"


DELAYS = ("0 ms", "1 ms", "2 ms", "3 ms", "300 us", "1500 us", "7 ms", "7 ms - now", "now % 2 ms")
INSTANTS = ("0 ms", "1 ms", "5 ms", "12300 us", "now", "now + 1 ms", "now + 2 ms - now % 2 ms", "3 * now")


def guard(draw: st.DrawFn, part: Part, free: list[str], *, watching: bool = False) -> tuple[str, str | None]:
    """A guard, and what the guarded process has to begin with; removes the port that it uses from ``free``."""
    condition = f"when {value(draw, part, 'bool', 1)} & " if draw(st.integers(0, 2)) == 0 else ""
    if not watching and draw(st.integers(0, 11)) == 0:
        return f"{condition}skip", None
    choice = draw(st.integers(0, 7)) if free else 7
    if choice == 7:
        timed = [*(f"after {delay}" for delay in DELAYS), *(f"at {instant}" for instant in INSTANTS)]
        return condition + draw(st.sampled_from(timed)), None
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
    for law in part.units:
        draw(st.sampled_from(parts)).units.append(law)
    return parts


COMPOSED = (
    ("seq",) * 2 + ("par", "mu", "while", "if", "catch", "group", "raise", "repeated", "forever")
    + ("alt",) * 2 + ("interrupt",) * 2
)  # fmt: skip


def step(draw: st.DrawFn, part: Part, depth: int) -> str:
    """A composition, as an operand."""
    kinds = ["access"] * 4 * bool(part.ports) + ["unit"] * 3 * bool(part.units) + ["assign", "wait", "skip"]
    kind = draw(st.sampled_from([*kinds, *COMPOSED] if depth > 0 else kinds))
    match kind:
        case "access":
            return f"({access(draw, part, draw(st.sampled_from(part.ports)))})"
        case "unit":
            return run_unit(draw, part, draw(st.sampled_from(part.units)))
        case "assign":
            return assignment(draw, part)
        case "wait":
            if draw(st.integers(0, 4)) == 0:
                return f"(wait until {draw(st.sampled_from(INSTANTS))})"
            delay = value(draw, part, "time", 1) if draw(st.integers(0, 4)) == 0 else draw(st.sampled_from(DELAYS))
            return f"(wait {delay})"
        case "skip":
            return draw(st.sampled_from(["skip", "skip", "stop"]))
        case _:
            return composed(draw, part, kind, depth)


def composed(draw: st.DrawFn, part: Part, kind: str, depth: int) -> str:
    """A composition of compositions."""
    inner = lambda: step(draw, part, depth - 1)  # noqa: E731
    match kind:
        case "seq":
            return f"({' ; '.join(inner() for _ in range(draw(st.integers(2, 4))))})"
        case "par":
            operator = draw(st.sampled_from([" || ", " ||> "]))
            return f"({operator.join(step(draw, p, depth - 1) for p in split(draw, part, draw(st.integers(2, 3))))})"
        case "alt":
            operator = draw(st.sampled_from([" [] ", " []> "]))
            free = list(part.ports)
            branches = [guarded(draw, part, free, depth - 1) for _ in range(draw(st.integers(2, 4)))]
            if draw(st.integers(0, 7)) == 0:  # two guards of one text are two guards
                branches += [f"(after {draw(st.sampled_from(DELAYS))} -> skip)"] * 2
            return f"({operator.join(branches)})"
        case "mu" | "while":
            return loop(draw, part, kind, depth)
        case "forever":
            return f"((mu ({inner()} ; wait 1 ms)) interrupt after {draw(st.integers(1, 9))} ms -> skip)"
        case "repeated":
            return f"(seq {part.leaf.fresh('each')} < {draw(st.integers(1, 3))} : {inner()})"
        case "if":
            return f"(if {value(draw, part, 'bool')} then {inner()} else {inner()})"
        case "raise":
            return f"(if {value(draw, part, 'bool')} then raise {draw(st.sampled_from(['Overheated', 'Jammed']))})"
        case "catch":
            name = draw(st.sampled_from(["Overheated", "Jammed", "Fault", "Timeout"]))
            return f"({inner()} catch {name} -> {inner()})"
        case "interrupt":
            return interrupted(draw, part, depth)
        case _:
            return f"({part.leaf.fresh('group')}: {inner()})"


def run_unit(draw: st.DrawFn, part: Part, unit: str) -> str:
    """A run of a control law, perhaps guarded, or of one of the processes of a unit."""
    part.used.add(unit)
    if unit in part.leaf.instances:
        (guard_port,) = part.leaf.units[unit] or ("",)
        forms = [f"({unit})", f"({unit} ; reset {unit})"] + ([f"({guard_port} -> {unit})"] if guard_port else [])
        return draw(st.sampled_from(forms))
    return f"({' ; '.join(draw(st.permutations(part.leaf.units[unit])))})"


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
    """A body that is interrupted through a port that it does not use itself, or after some time."""
    inputs = [p for p in part.ports if draw(st.booleans())]
    free = list(inputs[:1])
    watching = Part(part.leaf, free, [], part.leaf.fresh("_"), part.used)
    text, first = guard(draw, watching, free, watching=True)
    body = step(draw, part.without(*inputs[:1]), depth - 1)
    handler = step(draw, part, depth - 1)
    return f"({body} interrupt {text} -> {f'({first} ; {handler})' if first else handler})"


def _period(leaf: Leaf, port: str) -> str | None:
    """The period of a port, whatever its offset; None if it has none."""
    return leaf.periods[port].partition(" offset")[0] if port in leaf.periods else None


def add_law(draw: st.DrawFn, leaf: Leaf, free: list[str]) -> None:
    """A control law between inputs and outputs of one period, which it removes from ``free``."""
    doubles = [p for p in free if leaf.ports[p] == ("in", "double")]
    if not doubles:
        return
    period = _period(leaf, doubles[0])
    inputs = [p for p in doubles if _period(leaf, p) == period]
    outputs = [p for p in free if leaf.ports[p] == ("out", "double") and _period(leaf, p) in (None, period)]
    count = draw(st.sampled_from([1, 2, 2])) if len(inputs) > 1 else 1
    form = draw(st.sampled_from([f for f in LAWS if len(f.inputs) == count and (period is not None or not f.sampled)]))
    name = leaf.fresh("law")
    leaf.instances[name] = form.text
    inputs, outputs = inputs[: len(form.inputs)], [*outputs, "_", "_"][: len(form.outputs)]
    leaf.units[name] = (inputs[0],) if len(inputs) == 1 else ()
    leaf.arrows += [f"{port} -> {name}.{end}" for port, end in zip(inputs, form.inputs, strict=True)]
    leaf.arrows += [f"{name}.{end} -> {port}" for port, end in zip(outputs, form.outputs, strict=True)]
    for port in {*inputs, *outputs} - {"_"}:
        free.remove(port)


def add_processes(draw: st.DrawFn, leaf: Leaf, free: list[str], depth: int) -> None:
    """A unit of processes that run one after the other, with some of the ports, which it removes from ``free``."""
    ports = [port for port in free if draw(st.booleans())]
    most = 1 if leaf.alone & set(ports) else 2
    classes = [_inner(draw, leaf, ports) for _ in range(draw(st.integers(1, most)))]
    link = leaf.fresh("link") if len(classes) == 2 and draw(st.booleans()) else None
    if link is not None:
        kind = draw(st.sampled_from(sorted(INITIAL)))
        leaf.variables[link] = (kind, INITIAL[kind])
        classes[0].ports[link], classes[1].ports[link] = ("out", kind), ("in", kind)
    leaf.definitions += [leaf_text(draw, inner, depth - 1) for inner in classes]
    if link is None and most > 1 and draw(st.integers(0, 2)) == 0:
        classes.append(classes[0])
    names = [leaf.fresh("inner") for _ in classes]
    for name, inner in zip(names, classes, strict=True):
        leaf.instances[name] = inner.name + given(draw, inner, leaf)
    leaf.units[leaf.fresh("unit")] = tuple(names)
    for port in ports:
        ends = ", ".join(f"{name}.{port}" for name in names)
        leaf.arrows.append(f"{port} -> {ends}" if leaf.ports[port][0] == "in" else f"{ends} -> {port}")
        if leaf.ports[port][0] == "out" or port not in leaf.periods:
            free.remove(port)
    if link is not None:
        leaf.arrows += [f"{names[0]}.{link} -> {link}", f"{link} -> {names[1]}.{link}"]


def _inner(draw: st.DrawFn, leaf: Leaf, ports: list[str]) -> Leaf:
    inner = Leaf(leaf.fresh(f"{leaf.name}Part"))
    inner.ports = {port: leaf.ports[port] for port in ports}
    inner.alone = leaf.alone & set(ports)
    inner.periods = {port: leaf.periods[port] for port in ports if port in leaf.periods}
    add_parameters(draw, inner)
    return inner


def add_parameters(draw: st.DrawFn, leaf: Leaf) -> None:
    """Parameters of a process, and inputs that remain unconnected."""
    for kind in draw(st.lists(st.sampled_from(["int", "double", "bool", "Mode", "time"]), max_size=2)):
        leaf.parameters[leaf.fresh("k")] = kind
    if draw(st.integers(0, 3)) == 0:
        port, kind = leaf.fresh("spare"), draw(st.sampled_from(sorted(INITIAL)))
        leaf.ports[port] = ("in", kind)
        leaf.defaults[port] = INITIAL[kind]


def given(draw: st.DrawFn, leaf: Leaf, outer: Leaf | None = None) -> str:
    """The arguments of an instance: literals, or parameters of the process around it."""
    arguments = []
    for name, kind in leaf.parameters.items():
        known = [] if outer is None else [n for n, k in outer.parameters.items() if k == kind]
        arguments.append(f"{name} = {draw(st.sampled_from([*LITERALS[kind], *known, *known]))}")
    return f"({', '.join(arguments)})" if arguments else ""


def leaf_text(draw: st.DrawFn, leaf: Leaf, depth: int = 1) -> str:
    """The definition of a process, after those of the processes inside."""
    free = [port for port in leaf.ports if port not in leaf.defaults]
    for _ in range(draw(st.integers(0, 2))):
        add_law(draw, leaf, free)
    for _ in range(draw(st.integers(0, 2)) if depth > 0 else 0):
        add_processes(draw, leaf, free, depth)
    part = Part(leaf, [*free, *leaf.defaults], list(leaf.units), "", set())
    steps = [step(draw, part, draw(st.sampled_from([1, 2, 3, 3]))) for _ in range(draw(st.integers(1, 3)))]
    steps += [f"({access(draw, part, port)})" for port in part.ports if port not in part.used]
    steps += [run_unit(draw, part, unit) for unit in part.units if unit not in part.used]
    body = " ; ".join(draw(st.permutations(steps)))
    forever = f"mu ({step(draw, part, 1)} ; wait 2 ms)" if draw(st.integers(0, 7)) == 0 else "skip"
    parameters = ", ".join(f"{name}: {kind}" for name, kind in leaf.parameters.items())
    clause = draw(st.sampled_from(["", "", "", " wcet 20 us"]))
    ports = [f"  {direction} {name} : {kind}{_declared(leaf, name)}" for name, (direction, kind) in leaf.ports.items()]
    variables = [f"    var {name} : {kind} = {initial}" for name, (kind, initial) in leaf.variables.items()]
    instances = [f"    {name} : {definition}" for name, definition in leaf.instances.items()]
    return "\n".join(
        [
            *leaf.definitions,
            f"process {leaf.name}{f'({parameters})' if parameters else ''}{clause} {{", *ports, "  communication {",
            *variables, *instances, *(f"    {arrow}" for arrow in leaf.arrows), "  }",
            "  composition {", f"    {body} ; {forever}", "  }", "}", "",
        ]
    )  # fmt: skip


def _declared(leaf: Leaf, port: str) -> str:
    if port in leaf.defaults:
        return f" = {leaf.defaults[port]}"
    return f" {leaf.periods[port]}" if port in leaf.periods else ""
