"""Random programs of nested interrupts whose guards meet: each other in one process, those of interrupts in parallel,
an offer in their own body, or another process.

Each nest has an outermost guard that is a time-out, so a nest that waits for itself is left in the end.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from random import Random

from tests.conformance.random.meetings import (
    DELAYS,
    Leaf,
    Part,
    access,
    assembled,
    connected,
    external_ports,
    outside,
    plain,
    step,
)
from tests.conformance.random.nodes import Node, Program
from tests.conformance.random.plants import plant

KINDS = ("",) * 5 + (" any",) * 3 + (" buffer 1", " overwrite 1")
OTHER = {"?": "!", "!": "?"}


@dataclass(frozen=True)
class End:
    """One side of a channel of the process itself."""

    channel: str
    way: str

    @property
    def other(self) -> End:
        return End(self.channel, OTHER[self.way])

    def text(self, part: Part) -> str:
        """A reader or a writer."""
        value = part.variable("int") if self.way == "?" else part.value("int")
        return f"{self.channel} {self.way} {value}"


def channel(part: Part) -> End:
    """One side of a new channel."""
    name = part.leaf.fresh("own")
    part.leaf.laws.append(f"    channel {name} : int{part.draw.choice(KINDS)}")
    return End(name, part.draw.choice("?!"))


@dataclass
class Nest:
    """Nested interrupts, the innermost first: what their guards offer, and what is offered inside each."""

    part: Part
    guards: list[End | None]
    inside: list[list[End]] = field(default_factory=list)

    def offer(self, end: End, below: int) -> None:
        """Offer an end somewhere inside the interrupt of a level: at a guard, in the innermost body, or in a
        handler.
        """
        draw = self.part.draw
        free = [level for level in range(below) if self.guards[level] is None]
        if free and draw.random() < 0.6:
            self.guards[draw.choice(free)] = end
        else:
            self.inside[draw.randint(0, below)].append(end)


def nest(part: Part, depth: int, given: list[End]) -> Node:
    """Nested interrupts that offer each of the given ends somewhere."""
    draw = part.draw
    made = Nest(part, [None] * depth, [[] for _ in range(depth + 1)])
    for end in given:
        made.offer(end, depth)
    for level in reversed(range(depth)):
        if made.guards[level] is None and draw.random() < 0.6:
            end = channel(part)
            made.guards[level] = end
            made.offer(end.other, level)
    inner = offering(part, step(part, draw.choice([0, 1])), made.inside[0])
    for level, guard in enumerate(made.guards):
        inner = interrupted(part, inner, guard, made.inside[level + 1])
        if draw.random() < 0.45:
            inner = between(part, inner)
    return Node(f"({{}} interrupt after {draw.choice(['1 ms', '2 ms', '3 ms'])} -> {{}})", (inner, step(part, 0)))


def interrupted(part: Part, body: Node, end: End | None, inside: list[End]) -> Node:
    """A body with one guard, whose variables nothing in parallel with it uses."""
    draw = part.draw
    watching = Part(draw, part.leaf, list(part.ports), part.leaf.fresh("_"))
    condition = f"when {watching.value('bool')} & " if draw.random() < 0.1 else ""
    text = end.text(watching) if end else f"after {draw.choice(DELAYS)}"
    handler = offering(part, step(part, draw.choice([0, 0, 1])), inside)
    return Node(f"({{}} interrupt {plain(condition + text)} -> ({{}}))", (body, handler))


def offering(part: Part, inner: Node, ends: list[End]) -> Node:
    """A composition before or after which some ends are offered, alone or in an alternative."""
    for end in ends:
        text = plain(end.text(part))
        if part.draw.random() < 0.3:
            delay = part.draw.choice(["1 ms", "2 ms"])
            inner = Node(f"(({text} -> {{}}) [] (after {delay} -> {{}}))", (inner, step(part, 0)))
        else:
            order = (Node(f"({text})"), inner)
            inner = Node("", order if part.draw.random() < 0.6 else order[::-1], " ; ")
    return inner


def between(part: Part, inner: Node) -> Node:
    """Other compositions around an interrupt."""
    draw = part.draw
    choice = draw.random()
    if choice < 0.2:
        raised = Node(f"(if {plain(part.value('bool'))} then raise Jammed)")
        return Node("({} catch Jammed -> {})", (Node("", (inner, raised), " ; "), step(part, 0)))
    if choice < 0.35:
        return Node("({} catch Fault -> {})", (inner, step(part, 0)))
    if choice < 0.55:
        beside = Part(draw, part.leaf, [], part.leaf.fresh("_"))
        return Node("", (inner, step(beside, 1)), draw.choice([" || ", " ||> "]))
    if choice < 0.7:
        return repeated(part, inner)
    if choice < 0.85:
        return Node("", (step(part, 0), inner), " ; ")
    return Node(f"(if {plain(part.value('bool'))} then {{}} else {{}})", (inner, step(part, 0)))


def repeated(part: Part, inner: Node) -> Node:
    """A composition, two or three times."""
    counter = part.leaf.fresh("k")
    part.leaf.variables[counter] = ("int", "0")
    form = f"({counter} := 0 ; (mu ({{}} ; {counter} := {counter} + 1) until {counter} >= {part.draw.randint(2, 3)}))"
    return Node(form, (inner,))


def body(draw: Random, leaf: Leaf) -> Node:
    """What a process does: one nest, or two parallel ones that meet, several times."""
    part = Part(draw, leaf, list(leaf.ports))
    if draw.random() < 0.5:
        made = nest(part, draw.choice([1, 2, 2, 3]), [])
    else:
        ends = [channel(part) for _ in range(draw.choice([1, 1, 2]))]
        left, right = part.split(2)
        there = [end.other for end in ends]
        sides = (nest(left, draw.choice([1, 2]), ends), nest(right, draw.choice([1, 2]), there))
        made = Node("", sides, draw.choice([" || ", " || ", " ||> "]))
    ports = [Node(f"({plain(access(part, port))})") for port in part.ports if draw.random() < 0.2]
    return repeated(part, Node("", (made, *ports), " ; ") if ports else made)


def nested(seed: int) -> Program:
    """The program of a seed."""
    draw = Random(f"nested {seed}")
    external = external_ports(seed)
    leaves = [Leaf(f"Leaf{i}") for i in range(draw.randint(2, 3))]
    relations = [*connected(draw, leaves), *outside(draw, leaves, external)]
    return assembled(draw, leaves, [body(draw, leaf) for leaf in leaves], relations, external, plant(seed))
