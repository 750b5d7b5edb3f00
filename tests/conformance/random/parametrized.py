"""The programs of other generators with parameters, which change, in the place of some of their literals and constants:
in guards, delays, conditions, messages, initial values and the plant.
"""

from __future__ import annotations

import re
from random import Random

from tests.conformance.random.changes import drawn
from tests.conformance.random.meetings import meetings
from tests.conformance.random.nested import nested
from tests.conformance.random.nodes import Node, Program
from tests.conformance.random.tuned import Tuned

PARAMETERS = {
    "hold": ("time", "1 ms"), "rest": ("time", "2 ms"), "long": ("time", "3 ms"), "short": ("time", "500 us"),
    "late": ("time", "4500 us"), "share": ("double", "0.5"), "more": ("double", "1.25"), "open": ("bool", "true"),
    "closed": ("bool", "false"), "tiny": ("int8", "int8(100)"),
}  # fmt: skip
"""Parameters with the literals in whose places they come."""
EARLY = 6_000_000
"""Nanoseconds: many of these programs end soon."""
CONSTANTS = {"width": "int", "gain": "double", "pause": "time"}
"""Constants of the programs that become parameters."""


def parametrized(seed: int) -> Program:
    """The program of a seed."""
    draw = Random(f"parametrized {seed}")
    program = draw.choice([meetings, nested])(seed)
    names = draw.sample(sorted(PARAMETERS), draw.randint(3, len(PARAMETERS)))
    replaced = {PARAMETERS[name][1]: name for name in names}
    literal = re.compile(r"(?<![\w.])(" + "|".join(re.escape(text) for text in replaced) + r")(?![\w.])")

    def in_text(text: str) -> str:
        return literal.sub(lambda found: replaced[found[0]] if draw.random() < 0.6 else found[0], text)

    def in_node(node: Node) -> Node:
        return Node(in_text(node.form), tuple(map(in_node, node.children)), node.operator, node.guarded)

    constants = [name for name in CONSTANTS if draw.random() < 0.7]
    before = program.before
    for name in constants:
        before = re.sub(rf"^const {name} +=", f"parameter {name} : {CONSTANTS[name]} =", before, flags=re.MULTILINE)
    declared = "\n".join(f"parameter {name} : {PARAMETERS[name][0]} = {PARAMETERS[name][1]}" for name in names)
    before = re.sub(r"(gain: double) = \S+\)", r"\1 = share)", before) if "share" in names else before
    leaves = tuple(
        (name, re.sub(r"(?<= = ).*", lambda found: in_text(found[0]), text), in_node(body))
        for name, text, body in program.leaves
    )
    places = [*((name, PARAMETERS[name][0]) for name in names), *((name, CONSTANTS[name]) for name in constants)]
    changes = drawn(Random(f"changes {seed}"), places, EARLY)
    return Tuned(f"{declared}\n{before}", leaves, program.after, program.top, tuple(changes))
