"""Programs with arrays of instances, each also with its relationships and its composition written line by line.

Both forms have the same names, so they have the same network, and the same mistakes. Each program is a topology, in
which one thing may be wrong.
"""

from __future__ import annotations

import random
import re
from collections.abc import Callable, Iterator
from typing import NamedTuple

DEFINITIONS = """
exception Finished

process Cell(gain: int = 1) {{
  in  input  : int
  out output : int

  communication {{
    var value : int
  }}

  composition {{
    {cell}
  }}
}}

process Asker {{
  out request : int
  in  reply   : int

  communication {{
    var answer : int = 0
  }}

  composition {{
    mu (request ! answer ; reply ? answer)
  }}
}}

process Answerer {{
  in  request : int
  out reply   : int

  communication {{
    var question : int
  }}

  composition {{
    mu (request ? question ; reply ! question)
  }}
}}

process Server {{
  in  request[size] : int
  out reply[size]   : int

  communication {{
    var question : int
  }}

  composition {{
    {server}
  }}
}}
"""

CELLS = (
    "mu (input ? value ; output ! value + gain)",
    "mu (output ! gain ; input ? value)",
    "input ? value ; output ! value",
    "mu (input ? value -> output ! value % 7 [] after 5 ms -> skip)",
    "(mu (input ? value ; output ! value) until value == 5) ; raise Finished",
    "mu output ! value",
    "mu (wait gain * 1 ms ; input ? value ; output ! value)",
    "input ? value ; mu (output ! value) until value == 3",
)
SERVERS = (
    "mu (alt {i} < size : request[{i}] ? question -> reply[{i}] ! question % 1000 + {i})",
    "mu (prialt {i} < size : request[{i}] ? question -> reply[{i}] ! question)",
    "mu (seq {i} < size : (request[{i}] ? question ; reply[{i}] ! question))",
    "mu (alt {i} < size : request[{i}] -> (request[{i}] ? question ; reply[{i}] ! question))",
    "mu (alt {i} < size - 1 : request[{i}] ? question -> reply[{i}] ! question)",
    "mu (alt {i} < size : request[{i}] ? question -> reply[size - 1 - {i}] ! question)",
    "mu (alt {i} < size : request[{i} / 2] ? question -> reply[{i}] ! question)",
    "mu (alt {i} < size : request[{i}] ? question -> reply[{i} + 1] ! question)",
)


INDEX = re.compile(r"\{([^}]*)\}")


class Repeated(NamedTuple):
    """Parts of which there is one for each index below ``times``; in them ``{...}`` are expressions of the index."""

    times: str
    parts: tuple[str, ...]

    def in_a_loop(self, size: int) -> str:
        """The parts with the name of the index."""
        del size
        return "\n".join(re.sub(INDEX, r"\1", part) for part in self.parts)

    def each(self, size: int) -> Iterator[str]:
        """The parts with the value of each index, in the order of a loop."""
        for i in range(_value(self.times, size, 0)):
            for part in self.parts:
                yield re.sub(INDEX, lambda found: str(_value(found[1], size, i)), part)  # noqa: B023 - called at once


class Topology(NamedTuple):
    """An outermost process: what it declares, its relationships and its composition.

    A relationship and a part of the composition is repeated, or one text.
    """

    declarations: tuple[str, ...]
    relationships: tuple[Repeated | str, ...]
    composition: tuple[Repeated | str, ...]
    operator: str = "par"
    end: str = ""

    def text(self, size: int, cell: str, server: str, *, rolled: bool) -> str:
        """The program, with loops or with a line for each relationship and each step."""
        lines = [f"const size = {size}", DEFINITIONS.format(cell=cell, server=server.format(i="k")), "process Whole {"]
        lines += ["  communication {", *(f"    {declared}" for declared in self.declarations)]
        for relationship in self.relationships:
            lines += _related(relationship, size, rolled)
        sign = " || " if self.operator == "par" else " ; "
        steps = sign.join(_composed(step, self.operator, sign, size, rolled) for step in self.composition)
        lines += ["  }", "  composition {", f"    ({steps}){self.end}" if self.end else f"    {steps}", "  }", "}", ""]
        return "\n".join(lines)


def _related(relationship: Repeated | str, size: int, rolled: bool) -> Iterator[str]:
    if isinstance(relationship, str):
        yield f"    {relationship}"
    elif rolled:
        yield f"    for i < {relationship.times} {{"
        yield f"      {relationship.in_a_loop(size)}"
        yield "    }"
    else:
        yield from (f"    {one}" for one in relationship.each(size))


def _composed(step: Repeated | str, operator: str, sign: str, size: int, rolled: bool) -> str:
    if isinstance(step, str):
        return step
    if rolled:
        return f"({operator} i < {step.times} : {step.in_a_loop(size)})"
    return f"({sign.join(step.each(size))})"


class _Whole(int):
    """A number with the quotient of the language, which is rounded towards zero."""

    def __add__(self, other: int) -> _Whole:
        return _Whole(int(self) + int(other))

    def __sub__(self, other: int) -> _Whole:
        return _Whole(int(self) - int(other))

    def __mul__(self, other: int) -> _Whole:
        return _Whole(int(self) * int(other))

    def __truediv__(self, other: int) -> _Whole:
        return _Whole(abs(int(self)) // abs(int(other)) * (1 if self * other >= 0 else -1))

    def __mod__(self, other: int) -> _Whole:
        return self - self / other * other


def _value(expression: str, size: int, index: int) -> int:
    literal = re.sub(r"\d+", r"whole(\g<0>)", expression)
    return int(eval(literal, {"whole": _Whole, "size": _Whole(size), "i": _Whole(index)}))


RING = Topology(
    ("cell[size] : Cell",),
    (Repeated("size", ("cell[{i}].output -> cell[{(i + 1) % size}].input",)),),
    (Repeated("size", ("cell[{i}]",)),),
)
PIPELINE = Topology(
    ("first : Cell", "cell[i < size] : Cell(gain = i + 1)", "last : Cell"),
    (
        "first.output -> cell[0].input",
        Repeated("size - 1", ("cell[{i}].output -> cell[{i + 1}].input",)),
        "cell[size - 1].output -> last.input",
        "last.output -> first.input",
    ),
    ("first", Repeated("size", ("cell[{i}]",)), "last"),
)
PAIRS = Topology(
    ("asker[size] : Asker", "answerer[size] : Answerer"),
    (
        Repeated(
            "size",
            (
                "asker[{i}].request  -> answerer[{i}].request",
                "answerer[{i}].reply -> asker[{i}].reply",
            ),
        ),
    ),
    (Repeated("size", ("(asker[{i}] || answerer[{i}])",)),),
)
STAR = Topology(
    ("server : Server", "asker[size] : Asker"),
    (Repeated("size", ("asker[{i}].request -> server.request[{i}]", "server.reply[{i}] -> asker[{i}].reply")),),
    ("server", Repeated("size", ("asker[{i}]",))),
)
TOPOLOGIES = (RING, PIPELINE, PAIRS, STAR)

Mistake = Callable[[random.Random, Topology], Topology]


def _one(chosen: random.Random, among: tuple[Repeated | str, ...]) -> int:
    return chosen.choice([place for place, part in enumerate(among) if isinstance(part, Repeated)])


def _changed(topology: Topology, place: int, change: Callable[[Repeated], Repeated]) -> Topology:
    parts = list(topology.relationships)
    part = parts[place]
    assert isinstance(part, Repeated)
    parts[place] = change(part)
    return topology._replace(relationships=tuple(parts))


def other_index(chosen: random.Random, topology: Topology) -> Topology:
    """Another expression in place of one index."""
    indexes = (
        "i + 1", "i - 1", "i + 2", "size - 1 - i", "(i + 2) % size", "i / 2", "2 * i", "0", "size - 1", "i % 3",
        "i * i", "i * 1000000007", "(i + 1) % (size - 1)", "(i + size - 1) % size", "(i + 100) % size",
        "7 * i % size", "(i + size - 24) % size", "i % 200", "(i + i / 100) % size", "i / 100 + i % 100",
    )  # fmt: skip

    def change(part: Repeated) -> Repeated:
        texts = list(part.parts)
        place = chosen.randrange(len(texts))
        pieces = texts[place].split("{")
        which = chosen.randrange(1, len(pieces))
        pieces[which] = chosen.choice(indexes) + pieces[which][pieces[which].index("}") :]
        texts[place] = "{".join(pieces)
        return part._replace(parts=tuple(texts))

    return _changed(topology, _one(chosen, topology.relationships), change)


def other_count(chosen: random.Random, topology: Topology) -> Topology:
    """Another number of repetitions of relationships."""
    counts = ("size - 2", "size", "size + 1", "size - 1", "size / 2", "1", "2 * size")
    return _changed(
        topology, _one(chosen, topology.relationships), lambda part: part._replace(times=chosen.choice(counts))
    )


def missing(chosen: random.Random, topology: Topology) -> Topology:
    """One relationship less."""
    place = chosen.randrange(len(topology.relationships))
    rest = (*topology.relationships[:place], *topology.relationships[place + 1 :])
    return topology._replace(relationships=rest) if any(isinstance(part, Repeated) for part in rest) else topology


def twice(chosen: random.Random, topology: Topology) -> Topology:
    """A further relationship, between elements that are connected already."""
    array = "answerer" if topology is PAIRS else "asker" if topology is STAR else "cell"
    ports = ("reply", "request") if array != "cell" else ("output", "input")
    index = chosen.choice(("0", "1", "size - 1", "size", "size / 2"))
    further = f"{array}[{index}].{ports[0]} -> {array}[{chosen.choice(('0', '3', 'size - 2'))}].{ports[1]}"
    return topology._replace(relationships=(*topology.relationships, further))


def other_kind(chosen: random.Random, topology: Topology) -> Topology:
    """A kind of channel that is requested for all elements, or for one."""
    kind = chosen.choice(("any", "broadcast", "buffer 2", "overwrite 1", "sync", "overwrite size", "buffer i"))
    place = _one(chosen, topology.relationships)
    part = topology.relationships[place]
    assert isinstance(part, Repeated)
    texts = list(part.parts)
    texts[0] = texts[0].replace("->", f"-> {kind.replace('i', '{i}') if kind == 'buffer i' else kind} ->")
    return _changed(topology, place, lambda _: part._replace(parts=tuple(texts)))


def run_otherwise(chosen: random.Random, topology: Topology) -> Topology:
    """An element that never runs, runs twice, or a composition in sequence."""
    steps = list(topology.composition)
    place = _one(chosen, topology.composition)
    part = steps[place]
    assert isinstance(part, Repeated)
    match chosen.randrange(5):
        case 0:
            steps[place] = part._replace(times=chosen.choice(("size - 1", "size + 1", "size / 2")))
        case 1:
            index = chosen.choice(("i / 2", "size - 1 - i", "(i + 1) % size", "0", "i + 1"))
            steps[place] = part._replace(parts=tuple(text.replace("{i}", f"{{{index}}}", 1) for text in part.parts))
        case 2:
            array = part.parts[0].strip("(").partition("[")[0]
            steps.append(f"{array}[{chosen.choice(('0', 'size - 1', 'size'))}]")
        case 3:
            return topology._replace(operator="seq")
        case _:
            return topology._replace(end=" catch Finished -> skip")
    return topology._replace(composition=tuple(steps))


def other_argument(chosen: random.Random, topology: Topology) -> Topology:
    """Arguments that differ from element to element, overflow, or are not defined for one of them."""
    argument = chosen.choice(
        (
            "i", "size - i", "i * 9223372036854775807", "100 / i", "100 / (i - 3)", "100 % (size - 1 - i)", "-i",
            "if i == 4 then 1 / (i - 4) else i", "i - 4", "1000000007 * i * i", "i * 46116860184273879",
            "100 / (i - 200)",
        )
    )  # fmt: skip
    declared = ["cell[i < size] : Cell(gain = " + argument + ")" if "cell[" in d else d for d in topology.declarations]
    return topology._replace(declarations=tuple(declared))


def other_array(chosen: random.Random, topology: Topology) -> Topology:
    """An array with another number of elements."""
    count = chosen.choice(("size + 1", "size - 1", "size / 2", "size * 2", "0"))
    return topology._replace(
        declarations=tuple(
            d.replace("[size]", f"[{count}]").replace("i < size", f"i < {count}") for d in topology.declarations
        )
    )


MISTAKES: tuple[Mistake, ...] = (
    lambda _, topology: topology,
    other_index, other_count, missing, twice, other_kind, run_otherwise, other_argument, other_array,
)  # fmt: skip


def pair(seed: int, size: int) -> tuple[str, str]:
    """A program with loops, and the same line by line."""
    rolled, unrolled = forms(seed)
    return rolled(size), unrolled(size)


def forms(seed: int) -> tuple[Callable[[int], str], Callable[[int], str]]:
    """A program with loops, and the same line by line, each as a function of the number of elements."""
    chosen = random.Random(seed)
    topology = chosen.choice(TOPOLOGIES)
    cell = chosen.choice(CELLS) if chosen.random() < 0.4 else CELLS[0]
    server = chosen.choice(SERVERS) if chosen.random() < 0.6 else SERVERS[0]
    for _ in range(chosen.choice((0, 1, 1, 1, 2))):
        topology = chosen.choice(MISTAKES)(chosen, topology)

    def rolled(size: int) -> str:
        return topology.text(size, cell, server, rolled=True)

    def unrolled(size: int) -> str:
        return topology.text(size, cell, server, rolled=False)

    return rolled, unrolled
