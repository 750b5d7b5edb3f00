"""Random programs whose parameters change while they run: in laws and arrays of laws with initial values that follow
them, resets, guards, durations, arguments that are passed on, constants that follow, and the environment.

The changes are part of the program, in remarks at its end.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from random import Random

from tests.conformance.random.changes import drawn
from tests.conformance.random.gain_laws import Law, given, law
from tests.conformance.random.nodes import Node, Program
from tests.conformance.random.values import TYPES, Scope, declared, numbers

VARIABLES = {"double": "v_double", "int": "v_int", "bool": "v_bool", "time": "v_time", "Mode": "v_mode", "Gains": "v_g"}
ARGUMENTS = ("double", "int", "Gains", "bool", "Mode", "time", "Shape", "double[2]")
PERIODS = (" @ 1 ms", " @ 1 ms", " @ 2 ms", " @ 2 ms offset 700 us")


@dataclass(frozen=True)
class Tuned(Program):
    """A program with changes of its parameters, a line each."""

    changes: tuple[str, ...] = ()

    def __str__(self) -> str:
        return super().__str__() + "".join(f"// {line}\n" for line in self.changes)

    def smaller(self) -> Iterator[Program]:
        """Programs with fewer changes, a smaller composition, or fewer lines."""
        for gone in range(len(self.changes)):
            yield replace(self, changes=self.changes[:gone] + self.changes[gone + 1 :])
        yield from super().smaller()
        for index, (name, text, body) in enumerate(self.leaves):
            for other in _fewer_lines(text):
                yield replace(self, leaves=(*self.leaves[:index], (name, other, body), *self.leaves[index + 1 :]))
        yield from (replace(self, before=other) for other in _fewer_lines(self.before))
        yield from (replace(self, after=other) for other in _fewer_lines(self.after))


def _fewer_lines(text: str) -> Iterator[str]:
    lines = text.split("\n")
    for count in (8, 2, 1):
        for first in range(len(lines) - count + 1):
            yield "\n".join(lines[:first] + lines[first + count :])


@dataclass
class Worker:
    """A process under construction."""

    draw: Random
    name: str
    names: tuple[tuple[str, str], ...]
    """Of parameters and constants of the program."""
    laws: Sequence[Law]
    arguments: tuple[tuple[str, str], ...] = ()
    lines: list[str] = field(default_factory=list)
    """Of the communication diagram."""
    single: list[str] = field(default_factory=list)
    arrays: dict[str, int] = field(default_factory=dict)
    """The laws and arrays of laws."""
    outputs: int = 0
    counters: int = 0
    period: str = " @ 1 ms"

    def scope(self, faulting: float = 0.05) -> Scope:
        """What compositions compute with."""
        own = tuple((name, kind) for kind, name in VARIABLES.items())
        return Scope(self.draw, (*self.names, *self.arguments), faulting=faulting).with_names(*own)

    def constant(self) -> Scope:
        """What initial values and arguments are computed with."""
        return Scope(self.draw, (*self.names, *self.arguments), literals=0.2)

    def declare(self) -> None:
        """Variables, laws and arrays of laws, with arrows."""
        draw = self.draw
        for kind, name in VARIABLES.items():
            self.lines.append(f"    var {name} : {kind} = {self.constant().value(kind, 1)}")
        self.lines.append("    var v_pressed : int = 0")
        for number in range(draw.randint(1, 3)):
            chosen, source = draw.choice(self.laws), draw.choice(["x", "x", "v_double"])
            if draw.random() < 0.5:
                name, count = f"cell{number}", draw.randint(2, 3)
                inner = self.constant()
                indexed = Scope(draw, (*inner.names, ("i", "int"), ("i", "int")), literals=0.2)
                at = self.outputs
                self.lines += [
                    f"    {name}[i < {count}] : {chosen.name}{given(draw, chosen, indexed)}", f"    for i < {count} {{",
                    f"      {source} -> {name}[i].a", f"      v_int -> {name}[i].b",
                    f"      {name}[i].y -> y[{at} + i]", f"      {name}[i].n -> n[{at} + i]", "    }",
                ]  # fmt: skip
                self.arrays[name] = count
                self.outputs += count
            else:
                name = f"law{number}"
                self.lines += [
                    f"    {name} : {chosen.name}{given(draw, chosen, self.constant())}", f"    {source} -> {name}.a",
                    f"    v_int -> {name}.b", f"    {name}.y -> y[{self.outputs}]",
                    f"    {name}.n -> n[{self.outputs}]",
                ]  # fmt: skip
                self.single.append(name)
                self.outputs += 1

    def head(self) -> str:
        """Name and arguments."""
        inside = ", ".join(f"{name}: {kind}" for name, kind in self.arguments)
        return f"{self.name}({inside})" if inside else self.name

    def text(self) -> str:
        """Ports and the communication diagram."""
        ports = [
            f"  in  x : double{self.period}", "  in  press : int", f"  out y[{self.outputs}] : double{self.period}",
            f"  out n[{self.outputs}] : int", "  out o : int", "  out d : double",
        ]  # fmt: skip
        return "\n".join([*ports, "  communication {", *self.lines, "  }"])

    def duration(self) -> str:
        """Mostly longer than nothing."""
        draw = self.draw
        return f"{self.scope(0.0).value('time', draw.choice([0, 0, 1]))}{draw.choice([' + 1 ms', ' + 300 us', ''])}"

    def running(self) -> Node:
        """A run or a reset of a law, or of those of an array."""
        draw = self.draw
        act = draw.choice(["", "", "reset "])
        name = draw.choice([*self.single, *self.arrays])
        if name in self.single:
            return Node(f"({act}{name})")
        count = self.arrays[name]
        if draw.random() < 0.3:
            return Node(f"({act}{name}[{draw.randrange(count)}])")
        order = draw.choice(["seq", "par", "par"]) if not act else draw.choice(["seq", "seq", "par"])
        condition = f"if {self.scope(0.0).value('bool', 1)} then " if draw.random() < 0.2 else ""
        return Node(f"({order} i < {count} : {condition}{act}{name}[i])")

    def all_once(self) -> tuple[Node, ...]:
        """A run of every law."""
        runs = [Node(f"({name})") for name in self.single]
        runs += [Node(f"({self.draw.choice(['seq', 'par'])} i < {n} : {name}[i])") for name, n in self.arrays.items()]
        return tuple(self.draw.sample(runs, len(runs)))

    def guard(self) -> str:
        """A guard without what it guards."""
        draw, scope = self.draw, self.scope()
        condition = f"when {scope.value('bool', 1)} & " if draw.random() < 0.5 else ""
        return condition + draw.choice([
            f"after {self.duration()}", f"after {self.duration()}", f"at now + {self.duration()}", "press ? v_int",
            "x ? v_double", f"o ! {scope.value('int')}", f"at {self.duration()} * 3", "skip",
        ])  # fmt: skip

    def step(self, depth: int) -> Node:
        """A composition."""
        draw, scope = self.draw, self.scope()
        if depth == 0 or draw.random() < 0.35:
            choice = draw.random()
            if choice < 0.5:
                return self.running()
            if choice < 0.62:
                return Node(f"(o ! {scope.value('int', 3)})")
            if choice < 0.72:
                return Node(f"(d ! {scope.value('double', 3)})")
            if choice < 0.82:
                kind = draw.choice(sorted(VARIABLES))
                return Node(f"({VARIABLES[kind]} := {scope.value(kind)})")
            if choice < 0.96:
                return Node(draw.choice([f"(wait {self.duration()})", f"(wait until now + {self.duration()})"]))
            return Node(draw.choice(["(x ? v_double)", "(press ? v_int)"]))
        return self.composed(depth)

    def composed(self, depth: int) -> Node:
        """A composition of compositions."""
        draw = self.draw
        inner = tuple(self.step(depth - 1) for _ in range(draw.randint(2, 3)))
        match draw.choice(["seq", "seq", "alt", "alt", "interrupt", "interrupt", "if", "catch", "while", "mu", "par"]):
            case "alt":
                guarded = tuple(Node(f"({self.guard()} -> {{}})", (part,), guarded=True) for part in inner)
                last = Node(f"(after {self.duration()} -> {{}})", (Node(),), guarded=True)
                return Node("", (*guarded, last), draw.choice([" [] ", " []> "]))
            case "interrupt":
                after = f"after {self.duration()}" if draw.random() < 0.7 else "press ? v_pressed"
                condition = f"when {self.scope().value('bool', 1)} & " if draw.random() < 0.4 else ""
                if "press" in after and "press ?" in str(inner[0]):
                    after = "after 3 ms"
                return Node(f"({{}} interrupt {condition}{after} -> {{}})", inner[:2])
            case "if":
                return Node(f"(if {self.scope().value('bool')} then {{}} else {{}})", inner[:2])
            case "catch":
                return Node(f"({{}} catch {draw.choice(['Fault', 'Fault', 'Timeout'])} -> {{}})", inner[:2])
            case "while":
                return self.counted(
                    f"while {{0}} < {self.scope(0.0).value('int', 1)} % 4 do ({{{{}}}} ; {{0}} := {{0}} + 1)", inner[0]
                )
            case "mu":
                return self.counted(
                    f"mu ({{{{}}}} ; {{0}} := {{0}} + 1) until {{0}} >= {self.scope(0.0).value('int', 1)} % 4", inner[0]
                )
            case "par":
                beside = f"(wait {self.constant().value('time', 1)})"
                return Node(f"({{}} {draw.choice(['||', '||>'])} {beside})", inner[:1])
            case _:
                return Node("", inner, " ; ")

    def counted(self, form: str, body: Node) -> Node:
        """A loop with a counter of its own; ``form`` has places for the counter and for the body."""
        counter = f"k{self.counters}"
        self.counters += 1
        self.lines.append(f"    var {counter} : int = 0")
        return Node(f"({counter} := 0 ; ({form.format(counter)}))", (body,))


def _worker(
    draw: Random, number: int, names: tuple[tuple[str, str], ...], laws: Sequence[Law], period: str
) -> tuple[Worker, Node]:
    made = Worker(draw, f"Worker{number}", names, laws, period=period)
    made.arguments = tuple((f"a{at}", kind) for at, kind in enumerate(draw.sample(ARGUMENTS, draw.randint(0, 3))))
    made.declare()
    inside = Node("", tuple(made.step(draw.choice([1, 2, 3])) for _ in range(draw.randint(2, 4))), " ; ")
    inside = Node("", (inside, *made.all_once()), " ; ")
    caught = Node("({} catch Fault -> {})", (inside, made.step(1))) if draw.random() < 0.5 else inside
    return made, Node(f"(mu ({{}} ; wait {draw.choice(['1 ms', '2 ms', '700 us'])}))", (caught,))


def _plant(draw: Random, names: tuple[tuple[str, str], ...]) -> tuple[str, str]:
    """The submodel ``Plant``, and the arguments of its instance."""
    kinds = tuple((f"g{at}", kind) for at, kind in enumerate(draw.sample(ARGUMENTS, draw.randint(0, 2))))
    scope = Scope(draw, (*names, *kinds), True, faulting=0.02)
    held = scope.with_names(("u", "double"), ("k", "int"))
    linear = draw.random() < 0.5
    slope = (
        f"({scope.value('double', 1)} * z - x + {held.value('double')}) / (1 s)"
        if linear
        else (f"(limit({held.with_names(('x', 'double'), ('z', 'double')).value('double', 3)}, -40, 40) - x) / 5 ms")
    )
    start = Scope(draw, (*names, *kinds), True)
    lines = [
        f"submodel Plant({', '.join(f'{name}: {kind}' for name, kind in kinds)}) {{" if kinds else "submodel Plant {",
        "  in  u : double", "  in  o : int", "  out y : double", "  out press : int",
        f"  state x : double = {start.value('double', 1)}", f"  state z : double = {start.value('double', 0)}",
        f"  state k : int = {start.value('int', 1)}", f"  der x = {slope}",
        f"  der z = ({draw.choice(['0.5', scope.value('double', 0)])} * x - z) / (1 s)",
        f"  next k = (k + {scope.value('int', 1)} % 5 + o % 2) % 50",
        f"  y = {held.with_names(('x', 'double'), ('z', 'double')).value('double')}",
        f"  press = k / 4 + {scope.value('int', 1)} % 3", "}", "",
    ]  # fmt: skip
    arguments = ", ".join(f"{name} = {Scope(draw, names).value(kind, 1)}" for name, kind in kinds)
    return "\n".join(lines), f"({arguments})" if kinds else ""


def _gauge(shown: Sequence[tuple[str, str]]) -> str:
    """A law that writes what parameters are."""
    conversions = {"double": "{}", "bool": "(if {} then 1.0 else 0.0)", "time": "({} / 1 ms)"}
    lines = []
    for position, (name, kind) in enumerate(shown):
        by_mode = "(if {0} == Mode.slow then 0.0 else if {0} == Mode.fast then 1.0 else 2.0)"
        form = by_mode if kind == "Mode" else conversions.get(kind, "double({})")
        lines.append(f"  out w{position} : double")
        lines.append(f"  w{position} = {form.format(name)}")
    lines.sort(key=lambda line: not line.startswith("  out"))
    return "\n".join(["submodel Gauge {", "  in  x : double", *lines, "}", ""])


def tuned(seed: int) -> Program:
    """The program of a seed."""
    draw = Random(f"tuned {seed}")
    values = declared(draw)
    names = tuple(values.names)
    laws: list[Law] = []
    for number in range(draw.randint(1, 3)):
        laws.append(law(draw, number, names, draw.choice([0.0, 0.0, 0.1]), laws))
    period = draw.choice(PERIODS)
    workers = [_worker(draw, number, names, laws, period) for number in range(draw.randint(1, 2))]
    plant, plant_arguments = _plant(draw, names)
    shown = [part for whole in names for part in numbers(*whole)] if draw.random() < 0.4 else []
    shown = draw.sample(shown, min(len(shown), 12))
    before = "\n".join([TYPES, values.text, *(made.text for made in laws), plant, *([_gauge(shown)] if shown else [])])
    top = tuple((f"t{at}", kind) for at, kind in enumerate(draw.sample(ARGUMENTS, draw.randint(0, 2))))
    after, order = _outermost(draw, [worker for worker, _ in workers], (*names, *top), top, len(shown))
    head = ", ".join(f"{name} = {Scope(draw, names, literals=0.1).value(kind, 1)}" for name, kind in top)
    miss = draw.choice(["", " on miss count", " on miss count"])
    step = draw.choice([" step 1 ms", " step 500 us", ""])
    after += [
        f"environment Bench for Top{f'({head})' if head else ''}{step}{miss} {{", f"  plant : Plant{plant_arguments}",
        "  plant.y -> x", "  plant.press -> press",
        *_sinks([worker for worker, _ in workers], order, len(shown)), "}", "",
    ]  # fmt: skip
    changes = drawn(Random(f"changes {seed}"), [part for whole in values.parameters for part in numbers(*whole)])
    leaves = tuple((worker.head(), worker.text(), body) for worker, body in workers)
    instances = [name if count == 1 else f"(par i < {count} : {name}[i])" for name, count in order]
    if shown:
        instances.append("(mu (gauge))")
    return Tuned(before, leaves, "\n".join(after), Node("", tuple(map(Node, instances)), " || "), tuple(changes))


def _outermost(
    draw: Random,
    workers: Sequence[Worker],
    names: tuple[tuple[str, str], ...],
    top: tuple[tuple[str, str], ...],
    shown: int,
) -> tuple[list[str], list[tuple[str, int]]]:
    """The outermost process up to its composition, and its instances with their numbers."""
    ports, inside, order = [], [], []
    period = workers[0].period
    for number, worker in enumerate(workers):
        name, count, scope = f"work{number}", draw.choice([1, 1, 2]), Scope(draw, names, literals=0.15)
        indexed = Scope(draw, (*names, ("i", "int")), literals=0.15) if count > 1 else scope
        given_ = ", ".join(f"{name} = {indexed.value(kind, 1)}" for name, kind in worker.arguments)
        order.append((name, count))
        outputs = worker.outputs
        ports += [
            f"  out y{number}[{count * outputs}] : double{worker.period}", f"  out n{number}[{count * outputs}] : int",
            f"  out o{number}[{count}] : int", f"  out d{number}[{count}] : double",
        ]  # fmt: skip
        inside += [
            f"    {name}[i < {count}] : {worker.name}({given_})"
            if count > 1
            else f"    {name} : {worker.name}({given_})"
        ]
        for copy in range(count):
            here = f"{name}[{copy}]" if count > 1 else name
            inside += [f"    {here}.o -> o{number}[{copy}]", f"    {here}.d -> d{number}[{copy}]"]
            first = copy * outputs
            arrows = f"{here}.y[j] -> y{number}[{first} + j]  {here}.n[j] -> n{number}[{first} + j]"
            inside.append(f"    for j < {outputs} {{ {arrows} }}")
    readers = [f"{name}[{copy}]" if count > 1 else name for name, count in order for copy in range(count)]
    several = " broadcast ->" if len(readers) > 1 else ""
    inside += [f"    x -> {', '.join(f'{name}.x' for name in [*readers, *(['gauge'] if shown else [])])}"]
    inside += [f"    press ->{several} {', '.join(f'{name}.press' for name in readers)}"]
    if shown:
        ports += [f"  out w[{shown}] : double{period}"]
        inside += ["    gauge : Gauge", *(f"    gauge.w{at} -> w[{at}]" for at in range(shown))]
    head = ", ".join(f"{name}: {kind}" for name, kind in top)
    text = [
        f"process Top{f'({head})' if head else ''} {{", f"  in x : double{period}", "  in press : int", *ports,
        "  communication {", *inside, "  }", "  composition { {top} }", "}",
    ]  # fmt: skip
    return text, order


def _sinks(workers: Sequence[Worker], order: Sequence[tuple[str, int]], shown: int) -> list[str]:
    lines = ["  d0[0] -> plant.u", "  o0[0] -> plant.o"]
    for number, (worker, (_, count)) in enumerate(zip(workers, order, strict=True)):
        lines += [f"  for i < {count * worker.outputs} {{ y{number}[i] -> _  n{number}[i] -> _ }}"]
        lines += [f"  {port}{number}[{i}] -> _" for port in "od" for i in range(count) if (number, i) != (0, 0)]
    return [*lines, *([f"  for i < {shown} {{ w[i] -> _ }}"] if shown else [])]
