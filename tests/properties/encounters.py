"""Random programs whose processes meet in every way that the language knows, as text.

Processes run compositions that are drawn as trees, over channels of all kinds and ports of several rates, some in
groups of their own. Every program is well-typed and free of races; it may well deadlock, miss samples, overflow, or be
interrupted in the middle of anything.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from hypothesis import strategies as st

from tests.properties import laws, vocabulary
from tests.properties.leaves import Leaf, add_parameters, given, leaf_text
from tests.properties.vocabulary import INITIAL

PLANT = """exception Overheated

exception Jammed

submodel Plant {
  in  u1, u2, shown : double
  in  counted       : int
  in  placed        : Pose
  in  lamp          : Mode
  out y1, y2, y3    : double
  out press, turn   : int
  out pose          : Pose
  out mode          : Mode

  state x : double = 1
  state n : int    = 0
  state k : int    = 0
  der x = u1 - 0.5 * u2 - x
  next n = n + 1
  next k = (if counted > 5 or lamp == Mode.run then 0 else k + 1)
  y1    = x
  y2    = x + 0.1 * shown
  y3    = 2 * x
  press = n / 4
  turn  = (n + k) / 7 + counted / 3
  pose  = Pose(x = x - placed.x, n = n)
  mode  = if n % 9 < 4 then Mode.idle else if k % 5 == 0 then Mode.run else Mode.halt
}
"""

EXTERNAL = {
    "y1": ("in", "double", "@ 1 ms"),
    "y2": ("in", "double", "@ 2 ms"),
    "y3": ("in", "double", "@ 1 ms offset 400 us"),
    "press": ("in", "int", ""),
    "turn": ("in", "int", ""),
    "pose": ("in", "Pose", "@ 3 ms"),
    "mode": ("in", "Mode", ""),
    "u1": ("out", "double", "@ 1 ms safe 0.5"),
    "u2": ("out", "double", "@ 3 ms immediate"),
    "shown": ("out", "double", "@ 2 ms offset 700 us"),
    "counted": ("out", "int", ""),
    "placed": ("out", "Pose", "@ 2 ms"),
    "lamp": ("out", "Mode", "safe Mode.halt"),
}
SHARED = ("y1", "y2", "y3", "pose", "turn")
"""Inputs that several may read."""


@dataclass
class Relation:
    """Sources (``leaf0.o1``, or a port), the middle of the arrow, and sinks."""

    sources: list[str]
    middle: str
    sinks: list[str]

    def __str__(self) -> str:
        return " -> ".join(filter(None, [", ".join(self.sources), self.middle, ", ".join(self.sinks)]))


def connect(draw: st.DrawFn, leaves: Sequence[Leaf]) -> list[Relation]:
    """Channels between leaves, and external ports."""
    relations = []
    for number in range(draw(st.integers(1, 5))):
        kind = draw(st.sampled_from(["int", "double", *sorted(INITIAL)]))
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
            if shape == "broadcast":
                leaves[index].alone.add(f"i{number}")
        kind_of_channel = (
            "" if shape == "sync" or (shape in ("any", "broadcast") and writers == readers == 1) else f" {shape}"
        )
        left, right = [f"leaf{i}.o{number}" for i in sources], [f"leaf{i}.i{number}" for i in sinks]
        relations.append(Relation(left, f"c{number} : {kind}{kind_of_channel}", right))
    for name, (direction, kind, period) in EXTERNAL.items():
        chosen = list(draw(st.permutations(range(len(leaves)))))[: draw(st.integers(1, 2)) if name in SHARED else 1]
        for index in chosen:
            leaves[index].ports[name] = (direction, kind)
            if "@" in period:
                leaves[index].periods[name] = period.partition(" immediate")[0].partition(" safe")[0]
        inner = [f"leaf{i}.{name}" for i in chosen]
        kind_of_channel = draw(st.sampled_from(["broadcast", "any"])) if name == "turn" and len(chosen) == 2 else ""
        if kind_of_channel == "broadcast":
            for index in chosen:
                leaves[index].alone.add(name)
        relations.append(Relation([name], kind_of_channel, inner) if direction == "in" else Relation(inner, "", [name]))
    if draw(st.integers(0, 3)) == 0:
        leaves[0].ports["unheard"] = ("out", "int")
        relations.append(Relation(["leaf0.unheard"], "", ["_"]))
    return relations


def running(draw: st.DrawFn, parts: Sequence[str], once: str | None) -> str:
    """A composition of instances in parallel, some of them more than once."""
    forms = ["{0}", "{0}", "{0}", "({0} ; {0})", "(par i < 1 : {0})", "(seq i < 2 : {0})", "(pripar i < 1 : {0})"]
    names = [draw(st.sampled_from(forms[: 1 if p == once else None])).format(p) for p in draw(st.permutations(parts))]
    operator = draw(st.sampled_from([" || ", " || ", " ||> "]))
    if len(names) > 2 and draw(st.booleans()):
        inner = " ||> " if operator == " || " else " || "
        return f"({inner.join(names[:2])}){operator}{operator.join(names[2:])}"
    return operator.join(names) if len(names) > 1 else f"{names[0]} ; skip"


@dataclass
class Composite:
    """A process of processes under construction: instances by name, and relations among them and with ports."""

    instances: dict[str, str]
    relations: list[Relation]
    once: str | None = None
    """An instance that must not run twice: it communicates with itself through what others share."""

    def lines(self, draw: st.DrawFn, ports: Sequence[str], name: str) -> list[str]:
        """The definition of the process."""
        return [
            f"process {name} {{", *ports, "  communication {",
            *(f"    {instance} : {definition}" for instance, definition in self.instances.items()),
            *(f"    {relation}" for relation in self.relations), "  }",
            "  composition {", f"    {running(draw, list(self.instances), self.once)}", "  }", "}", "",
        ]  # fmt: skip


def grouped(draw: st.DrawFn, whole: Composite, leaves: Sequence[Leaf]) -> list[str]:
    """Put some of the leaves into a process of their own; returns its definition."""
    inside = list(draw(st.permutations(range(len(leaves)))))[: draw(st.integers(1, len(leaves) - 1))]
    members = {f"leaf{index}": leaves[index] for index in sorted(inside)}
    group = Composite({name: whole.instances.pop(name) for name in members}, [])
    ports: dict[str, str] = {}

    def port_for(end: str, direction: str) -> str:
        name, _, port = end.partition(".")
        through = f"{name}_{port}"
        ports[through] = f"  {direction} {through} : {members[name].ports[port][1]}"
        relation = Relation([through], "", [end]) if direction == "in" else Relation([end], "", [through])
        group.relations.append(relation)
        return f"group.{through}"

    remaining = []
    for relation in whole.relations:
        ends = [*relation.sources, *relation.sinks]
        if all(end.partition(".")[0] in members or end == "_" for end in ends):
            group.relations.append(relation)
            continue
        if all(any(e.partition(".")[0] in members for e in side) for side in (relation.sources, relation.sinks)):
            whole.once = "group"
        relation.sources = [port_for(e, "out") if e.partition(".")[0] in members else e for e in relation.sources]
        relation.sinks = [port_for(e, "in") if e.partition(".")[0] in members else e for e in relation.sinks]
        remaining.append(relation)
    whole.relations = remaining
    whole.instances["group"] = "Group"
    return group.lines(draw, list(ports.values()), "Group")


@st.composite
def encounters(draw: st.DrawFn) -> str:
    """An entire program with its environment ``Bench``."""
    leaves = [Leaf(f"Leaf{i}") for i in range(draw(st.integers(2, 4)))]
    relations = connect(draw, leaves)
    for leaf in leaves:
        add_parameters(draw, leaf)
    definitions = [leaf_text(draw, leaf) for leaf in leaves]
    top = Composite({f"leaf{i}": f"Leaf{i}{given(draw, leaf)}" for i, leaf in enumerate(leaves)}, relations)
    group = grouped(draw, top, leaves) if draw(st.booleans()) else []
    ports = [f"  {direction} {name} : {kind} {period}".rstrip() for name, (direction, kind, period) in EXTERNAL.items()]
    step_ = draw(st.sampled_from(["1 ms", "500 us", "2 ms", "1500 us"]))
    miss = draw(st.sampled_from(["", " on miss count"]))
    wires = [
        f"  plant.{name} -> {name}" if direction == "in" else f"  {name} -> plant.{name}"
        for name, (direction, _, _) in EXTERNAL.items()
    ]
    environment = [f"environment Bench for Top step {step_}{miss} {{", "  plant : Plant", *wires, "}", ""]
    parts = [vocabulary.DEFINITIONS, laws.DEFINITIONS, PLANT, *definitions, *group]
    return "\n".join([*parts, *top.lines(draw, ports, "Top"), *environment])
