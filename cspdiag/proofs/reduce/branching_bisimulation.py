"""Minimizes state machines modulo branching bisimulation that preserves divergence (van Glabbeek and Weijland,
"Branching time and abstraction in bisimulation semantics", 1996).

Blocks of states are split by signatures until none changes (Blom and Orzan, "Distributed branching bisimulation
reduction of state spaces", 2003): the steps that a state can take, possibly after internal steps within its block, each
with the block that it leads to. A cycle of internal steps becomes one state with an internal loop, so a livelock never
becomes a deadlock.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TypeAlias

from cspdiag.base.graphs import strong_components
from cspdiag.base.record import record
from cspdiag.proofs.transitions.systems.system import INTERNAL, Edge
from cspdiag.proofs.verdict import Limits

Signature: TypeAlias = frozenset[tuple[int, int]]

_LOOP = -1
"""The target in a signature that means the block itself: an internal loop."""


@record
class Machine:
    """A state machine: the edges of each state, and whether all processes in the machine have ended there. The first
    state is the initial one.
    """

    edges: tuple[tuple[Edge, ...], ...]
    ended: tuple[bool, ...]


def minimized(machine: Machine, limits: Limits | None = None) -> Machine:
    """The smallest equivalent machine, its states in the order in which they are reached. Raises LimitError."""
    machine = _without_internal_cycles(machine)
    order = [state for [state] in _internal_components(machine)]
    blocks = [int(ended) for ended in machine.ended]
    count = len(set(blocks))
    while True:
        signatures = _signatures(machine, order, blocks, limits)
        numbers: dict[tuple[int, Signature], int] = {}
        finer = [
            numbers.setdefault((block, signature), len(numbers))
            for block, signature in zip(blocks, signatures, strict=True)
        ]
        if len(numbers) == count:
            return _quotient(machine, blocks, signatures)
        blocks, count = finer, len(numbers)


def _signatures(
    machine: Machine, order: Sequence[int], blocks: Sequence[int], limits: Limits | None
) -> list[Signature]:
    """The signature of each state for the given blocks; ``order`` has the targets of internal steps before their
    sources.
    """
    found: list[Signature] = [frozenset()] * len(blocks)
    for at, state in enumerate(order):
        if limits is not None and at % 1024 == 0:
            limits.check()
        steps: set[tuple[int, int]] = set()
        for event, target in machine.edges[state]:
            if event != INTERNAL or blocks[target] != blocks[state]:
                steps.add((event, blocks[target]))
            elif target == state:
                steps.add((INTERNAL, _LOOP))
            else:
                steps |= found[target]
        found[state] = frozenset(steps)
    return found


def _quotient(machine: Machine, blocks: Sequence[int], signatures: Sequence[Signature]) -> Machine:
    """The machine of the reachable blocks; all states of a block have one signature."""
    member: dict[int, int] = {}
    for state, block in enumerate(blocks):
        member.setdefault(block, state)
    numbers = {blocks[0]: 0}
    pending = [blocks[0]]
    edges: list[tuple[Edge, ...]] = []
    for block in pending:
        found = []
        for event, led_to in sorted(signatures[member[block]]):
            target = block if led_to == _LOOP else led_to
            if target not in numbers:
                numbers[target] = len(pending)
                pending.append(target)
            found.append((event, numbers[target]))
        edges.append(tuple(found))
    return Machine(tuple(edges), tuple(machine.ended[member[block]] for block in pending))


def _internal_components(machine: Machine) -> Iterator[list[int]]:
    def after(state: int) -> list[int]:
        return [target for event, target in machine.edges[state] if event == INTERNAL]

    return strong_components(range(len(machine.edges)), after)


def _without_internal_cycles(machine: Machine) -> Machine:
    """The machine with each cycle of internal steps merged into one state with an internal loop. Whether that state has
    ended does not matter: it is never a deadlock.
    """
    components = list(_internal_components(machine))
    if all(len(component) == 1 for component in components):
        return machine
    merged = [0] * len(machine.edges)
    for component in components:
        for state in component:
            merged[state] = min(component)
    kept = sorted(set(merged))
    number = {state: at for at, state in enumerate(kept)}
    edges: list[dict[Edge, None]] = [{} for _ in kept]
    for state, offered in enumerate(machine.edges):
        for event, target in offered:
            edges[number[merged[state]]][event, number[merged[target]]] = None
    return Machine(tuple(tuple(found) for found in edges), tuple(machine.ended[state] for state in kept))
