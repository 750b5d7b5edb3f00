"""Random programs whose processes communicate with elements of arrays of ports: in turn, in nested `seq`, or with
whichever is ready, in replicated alternatives.

Two processes follow one plan of turns, so they would meet in each of them. What they do around a communication differs:
they wait, fail, choose between an element and a time-out, or are interrupted.
"""

from __future__ import annotations

from dataclasses import dataclass
from random import Random
from typing import TypeAlias

from tests.conformance.random.meetings import Leaf, Part, law, plain
from tests.conformance.random.nodes import Node, Program
from tests.properties.vocabulary import DEFINITIONS

SIZE = 6
"""The elements of each array."""
KINDS = ("",) * 5 + (" buffer 1 ->", " buffer 3 ->", " overwrite 1 ->", " any ->")
TYPES = ("int", "int", "int", "double", "bool", "uint16")
OUTSIDE = {
    "level": ("in", "double", " @ 1 ms"),
    "press": ("in", "int", ""),
    "drive": ("out", "double", " @ 2 ms"),
    "lamp": ("out", "bool", ""),
}
MARK = "marks"
"""A variable of each process, an array as long as those of ports."""

LAWS = """exception Overheated
exception Jammed

submodel Sums {
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

submodel Plant step 500 us {
  out level[6] : double
  out press[6] : int

  state t : double = 0
  der t = 1
"""


@dataclass(frozen=True)
class Meeting:
    """A communication with the element of an array, whose index is an expression."""

    array: str
    index: str


@dataclass(frozen=True)
class Turns:
    """What is repeated for each value of an index."""

    index: str
    count: int
    steps: tuple[Planned, ...]


@dataclass(frozen=True)
class Served:
    """What is repeated for each value of an index, of which the process that reads (``way`` is ``in``) or writes in the
    ``meeting`` takes whichever is ready.
    """

    index: str
    count: int
    meeting: Meeting
    way: str
    steps: tuple[Planned, ...]


Planned: TypeAlias = Meeting | Turns | Served


def planned(draw: Random, arrays: list[str], indexes: dict[str, int], names: list[int]) -> Turns:
    """Turns inside those of the given ``indexes``, with the number of turns of each."""
    names[0] += 1
    index, count = f"each{names[0]}", draw.choice((2, 3, 3, 4, 5, 6) if len(indexes) < 2 else (2, 3, 3))
    inside = {**indexes, index: count}
    steps: list[Planned] = []
    for _ in range(draw.choice((1, 1, 2, 3))):
        if len(inside) < 3 and draw.random() < 0.3:
            steps.append(planned(draw, arrays, inside, names))
        elif len(inside) == 1 and draw.random() < 0.1:
            steps.append(served(draw, arrays, inside, names))
        else:
            steps.append(Meeting(draw.choice(arrays), element(draw, inside)))
    return Turns(index, count, tuple(steps))


def served(draw: Random, arrays: list[str], indexes: dict[str, int], names: list[int]) -> Served:
    """What is served inside the turns of the given ``indexes``."""
    names[0] += 1
    index, count = f"each{names[0]}", draw.choice((2, 3, 4, 5, 6, 6) if not indexes else (2, 3, 3))
    inside = {**indexes, index: count}
    # Two guards of one alternative do not read the same element.
    forms = [index] * 3 + [f"{SIZE - 1} - {index}", f"({index} + 1) % {SIZE}"]
    forms += [f"({index} + {outer}) % {SIZE}" for outer in indexes]
    if count < SIZE:
        forms.append(f"{index} + {SIZE - count}")
    chosen = draw.choice(forms)
    others = [
        Meeting(draw.choice(arrays), draw.choice((chosen, element(draw, inside))))
        for _ in range(draw.choice((0, 1, 1, 2) if not indexes else (0, 1)))
    ]
    steps: list[Planned] = [*others]
    if not indexes and draw.random() < 0.1:
        steps.append(planned(draw, arrays, inside, names))
    return Served(
        index, count, Meeting(draw.choice(arrays), chosen), draw.choice(("in", "in", "in", "out")), tuple(steps)
    )


def element(draw: Random, indexes: dict[str, int]) -> str:
    """An index that is in the array in each turn."""
    index, count = draw.choice([*indexes.items()])
    forms = [index, index, index, f"{SIZE - 1} - {index}", str(draw.randrange(SIZE)), f"({index} + 1) % {SIZE}"]
    if count < SIZE:
        forms += [f"{index} + {draw.randint(1, SIZE - count)}"] * 2
    if 2 * count <= SIZE:
        forms += [f"2 * {index}", f"2 * {index} + 1", f"{index} / 2"]
    if len(indexes) > 1:
        others = [*indexes]
        forms += [f"({others[0]} + {others[-1]}) % {SIZE}"]
        if indexes[others[0]] + indexes[others[-1]] <= SIZE + 1:
            forms += [f"{others[0]} + {others[-1]}"] * 3
        if indexes[others[0]] * indexes[others[-1]] <= SIZE:
            forms += [f"{others[0]} * {indexes[others[-1]]} + {others[-1]}"] * 3
    return draw.choice(forms)


@dataclass
class Side:
    """What one process does of a plan: ``arrays`` are its ports, with their direction and type."""

    draw: Random
    part: Part
    arrays: dict[str, tuple[str, str]]

    def step(self, plan: Planned) -> Node | None:
        """What this process does; None if it takes no part."""
        match plan:
            case Turns():
                return self.turns(plan)
            case Served():
                return self.served(plan)
            case Meeting():
                return self.meeting(plan)

    def served(self, plan: Served) -> Node | None:
        """The alternative of the process that serves, again and again; for others it is a sequence."""
        array = plan.meeting.array
        if array not in self.arrays or self.arrays[array][0] != plan.way:
            return self.turns(Turns(plan.index, plan.count, (plan.meeting, *plan.steps)))
        draw, leaf = self.draw, self.part.leaf
        counter = leaf.fresh("k")
        leaf.variables[counter] = ("int", "0")
        leaf.indexes.append(plan.index)
        steps = [each for step in plan.steps for each in (*self.between(0.3), self.step(step)) if each is not None]
        body = Node("", (*steps, *self.between(0.6)), " ; ") if steps else self.plain_step()
        if draw.random() < 0.15:
            body = self.around(body)
        condition = f"when {plain(self.part.value('bool'))} & " if draw.random() < 0.15 else ""
        guard = f"{condition}{plain(self.access(array, plan.meeting.index))}"
        leaf.indexes.pop()
        word, operator = draw.choice((("alt", " [] "), ("alt", " [] "), ("prialt", " []> ")))
        guards = [Node(f"({word} {plan.index} < {plan.count} : ({guard} -> {{}}))", (body,))]
        if draw.random() < 0.3:
            other = draw.choice(["after 2 ms", "skip", *map(plain, self.another(array))])
            guards.append(self.guarded(other))
            draw.shuffle(guards)
        choice = Node("", tuple(guards), operator) if len(guards) > 1 else guards[0]
        rounds = draw.choice((plan.count, plan.count, 2 * plan.count))
        return Node(
            f"({counter} := 0 ; (mu ({{}} ; {counter} := {counter} + 1) until {counter} >= {rounds}))", (choice,)
        )

    def turns(self, plan: Turns) -> Node | None:
        """The turns of this process; None if it takes part in none."""
        indexes = self.part.leaf.indexes
        indexes.append(plan.index)
        steps: list[Node] = []
        for step in plan.steps:
            made = self.step(step)
            if made is not None:
                steps += [*self.between(0.25), made]
        if steps:
            steps += self.between(0.2)
        indexes.pop()
        if not steps:
            return None
        body = (
            self.around(Node("", tuple(steps), " ; ")) if self.draw.random() < 0.25 else Node("", tuple(steps), " ; ")
        )
        return Node(f"(seq {plan.index} < {plan.count} : {{}})", (body,))

    def meeting(self, step: Meeting) -> Node | None:
        """The communication of this process, alone or in a composition."""
        if step.array not in self.arrays:
            return None
        text, choice = plain(self.access(step.array, step.index)), self.draw.random()
        if choice < 0.65:
            return Node(f"({text})")
        other = self.draw.choice([f"after {self.draw.choice(('1 ms', '2 ms', '500 us'))}", *self.another(step.array)])
        if choice < 0.75:
            operator = self.draw.choice((" [] ", " []> "))
            return Node("", (self.guarded(text), self.guarded(plain(other))), operator)
        if choice < 0.82:
            condition = plain(self.part.value("bool"))
            return Node(f"(if {condition} then {{}} else {{}})", (Node(f"({text})"), self.plain_step()))
        if choice < 0.87:
            return Node("", (Node(f"({text})"), Node("(wait 100 us)")), " || ")
        return self.around(Node(f"({text})"))

    def guarded(self, text: str) -> Node:
        """A guarded process."""
        condition = f"when {plain(self.part.value('bool'))} & " if self.draw.random() < 0.1 else ""
        return Node(f"({condition}{text} -> {{}})", (self.plain_step(),), guarded=True)

    def around(self, inner: Node) -> Node:
        """What can end a composition before it is complete, around it."""
        match self.draw.choice(("interrupt", "interrupt", "catch", "loop", "group", "while")):
            case "interrupt":
                delay = self.draw.choice(("500 us", "1 ms", "2 ms", "3 ms"))
                return Node(f"({{}} interrupt after {delay} -> {{}})", (inner, self.plain_step()))
            case "catch":
                raised = Node(f"(if {plain(self.part.value('bool'))} then raise Jammed)")
                both = Node("", (inner, raised), " ; ") if self.draw.random() < 0.5 else inner
                name = self.draw.choice(("Jammed", "Fault", "Overheated"))
                return Node(f"({{}} catch {name} -> {{}})", (both, self.plain_step()))
            case "group":
                return Node(f"({self.part.leaf.fresh('group')}: {{}})", (inner,))
            case kind:
                counter = self.part.leaf.fresh("k")
                self.part.leaf.variables[counter] = ("int", "0")
                repeated = f"({{}} ; {counter} := {counter} + 1)"
                form = (
                    f"(mu {repeated} until {counter} >= 1)"
                    if kind == "loop"
                    else f"(while {counter} < 1 do {repeated})"
                )
                return Node(f"({counter} := 0 ; {form})", (inner,))

    def between(self, probability: float) -> list[Node]:
        """A step before or after others."""
        return [self.plain_step()] if self.draw.random() < probability else []

    def plain_step(self) -> Node:
        """A step without ports."""
        part, indexes = self.part, self.part.leaf.indexes
        choice = self.draw.random()
        if choice < 0.2:
            return Node(f"(wait {self.draw.choice(('100 us', '0 ms', '1 ms'))})")
        if choice < 0.3 and indexes:
            return Node(f"(wait {self.draw.choice(indexes)} * 100 us)")
        if choice < 0.5 and indexes:
            return Node(f"({MARK}[{self.draw.choice(indexes)}] := {plain(part.value('int', 2))})")
        if choice < 0.7:
            return Node(f"({part.variable('int')} := {plain(part.value('int', 2))})")
        if choice < 0.75:
            return Node(law(part))
        if choice < 0.78:
            return Node(f"(if {plain(part.value('bool'))} then raise {self.draw.choice(('Jammed', 'Overheated'))})")
        return Node()

    def access(self, array: str, index: str) -> str:
        """A reader or a writer."""
        way, kind = self.arrays[array]
        if way == "out":
            values = [self.part.value(kind)] * 2 + [f"{MARK}[{index}]"] * (kind == "int")
            return f"{array}[{index}] ! {self.draw.choice(values)}"
        targets = [self.part.variable(kind)] + [f"{MARK}[{index}]"] * (kind == "int")
        return f"{array}[{index}] ? {self.draw.choice(targets)}"

    def another(self, array: str) -> list[str]:
        """A communication with a constant element of another array."""
        others = [name for name in self.arrays if name != array]
        return [self.access(self.draw.choice(others), str(self.draw.randrange(SIZE)))] if others else []


def turns(seed: int) -> Program:
    """The program of a seed."""
    draw = Random(f"turns {seed}")
    leaves = [Leaf(f"Leaf{number}") for number in range(draw.randint(2, 3))]
    arrays: list[dict[str, tuple[str, str]]] = [{} for _ in leaves]
    relations: list[str] = []
    for number in range(draw.randint(1, 4)):
        kind = draw.choice(TYPES)
        writer, reader = draw.sample(range(len(leaves)), 2)
        arrays[writer][f"c{number}"] = ("out", kind)
        arrays[reader][f"c{number}"] = ("in", kind)
        middle = draw.choice(KINDS)
        relations.append(f"for i < {SIZE} {{ leaf{writer}.c{number}[i] ->{middle} leaf{reader}.c{number}[i] }}")
    for name, (way, kind, period) in OUTSIDE.items():
        owner = draw.randrange(len(leaves))
        arrays[owner][name] = (way, kind)
        leaves[owner].periods[f"{name}[{SIZE}]"] = period
        relations.append(f"{name} -> leaf{owner}.{name}" if way == "in" else f"leaf{owner}.{name} -> {name}")
    names, used = [0], sorted({name for own in arrays for name in own})
    plans = [draw.choice((planned, served))(draw, used, {}, names) for _ in range(draw.randint(2, 4))]
    # A choice may read any element, so each has a writer.
    plans.append(Turns("last", SIZE, tuple([Meeting(name, "last") for name in used])))
    bodies = []
    for leaf, own in zip(leaves, arrays, strict=True):
        leaf.ports = {f"{name}[{SIZE}]": kind for name, kind in own.items()}
        leaf.variables[MARK] = (f"int[{SIZE}]", str([*range(SIZE)]))
        bodies.append(_body(draw, Side(draw, Part(draw, leaf, []), own), plans))
    definitions = tuple((leaf.name, leaf.declared(), body) for leaf, body in zip(leaves, bodies, strict=True))
    top = Node("", tuple(Node(f"leaf{number}") for number in range(len(leaves))), " || ")
    return Program(f"{DEFINITIONS}\n{LAWS}{_plant(draw)}", definitions, _outermost(leaves, relations), top)


def _body(draw: Random, side: Side, plans: list[Turns | Served]) -> Node:
    """All plans one after the other, two or three times; each is left at last if the others do not follow it."""
    leaf, steps = side.part.leaf, []
    for plan in plans:
        made = side.step(plan)
        if made is None:
            continue
        steps.append(made if draw.random() < 0.4 else Node("({} interrupt after 7 ms -> skip)", (made,)))
    counter = leaf.fresh("k")
    leaf.variables[counter] = ("int", "0")
    rounds = f"(mu ({{}} ; {counter} := {counter} + 1) until {counter} >= {draw.randint(1, 3)})"
    return Node(rounds, (Node("", tuple(steps), " ; ") if steps else Node(),))


def _plant(draw: Random) -> str:
    levels = [f"  level[{i}] = {draw.choice(('t', '1 - t', '2 * t', 't * t'))} * {i + 1}" for i in range(SIZE)]
    presses = [f"  press[{i}] = int(t * {draw.choice((500, 1000, 300))}) / {i + 1}" for i in range(SIZE)]
    return "\n".join([*levels, *presses, "}", ""])


def _outermost(leaves: list[Leaf], relations: list[str]) -> str:
    ports = [f"  {way} {name}[{SIZE}] : {kind}{period}" for name, (way, kind, period) in OUTSIDE.items()]
    instances = [f"    leaf{number} : {leaf.name}" for number, leaf in enumerate(leaves)]
    return "\n".join(
        [
            "process Top {", *ports, "  communication {", *instances, *(f"    {each}" for each in relations), "  }",
            "  composition { {top} }", "}", "environment Bench for Top {", "  plant : Plant",
            *(f"  plant.{name} -> {name}" for name, (way, *_) in OUTSIDE.items() if way == "in"),
            *(f"  {name} -> _" for name, (way, *_) in OUTSIDE.items() if way == "out"), "}", "",
        ]
    )  # fmt: skip
