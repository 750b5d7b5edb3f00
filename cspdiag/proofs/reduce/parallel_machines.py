"""Composes two machines into one; events that no other machine shares become internal.

A machine numbers its events in the order in which they are first reached, so instances of one process have equal
machines, and equal pairs are composed only once.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable
from typing import TypeAlias

from cspdiag.base.record import record
from cspdiag.proofs.reduce.branching_bisimulation import Machine, minimized
from cspdiag.proofs.transitions.systems.system import INTERNAL, Component, Edge
from cspdiag.proofs.verdict import Limits

MOST_STATES = 50_000
"""The composition of a pair is given up if it has more states: minimizing it would take too long."""


class TooLargeError(Exception):
    """A pair has more than MOST_STATES states."""


Renamed: TypeAlias = dict[int, int]
"""The numbers of a machine's events in the machine of a pair; INTERNAL for those that become internal."""


@record
class MachineInSystem:
    """A machine, and the event of the system for each of its events, including those that it never offers."""

    machine: Machine
    events: tuple[int, ...]


def part_of(component: Component, alphabet: Iterable[int], hidden: Collection[int]) -> MachineInSystem:
    """The machine of a component that is party to the events of an alphabet; hidden events become internal."""
    numbers = {component.initial: 0}
    pending = [component.initial]
    events: dict[int, int] = {}
    edges: list[tuple[Edge, ...]] = []
    for state in pending:
        found: dict[Edge, None] = {}
        for event, target in component.edges[state]:
            if target not in numbers:
                numbers[target] = len(pending)
                pending.append(target)
            known = INTERNAL if event == INTERNAL or event in hidden else events.setdefault(event, len(events))
            found[known, numbers[target]] = None
        edges.append(tuple(found))
    for event in sorted(set(alphabet).difference(hidden)):
        events.setdefault(event, len(events))
    ended = tuple(not component.process or state in component.terminal for state in pending)
    return MachineInSystem(Machine(tuple(edges), ended), tuple(events))


def with_divergent_states_merged(machine: Machine) -> Machine:
    """The machine with all states merged from which internal steps are possible forever, whatever other machines do.

    Such a state has only an internal loop, or it has an internal step to such a state, and no steps except to such
    states and to itself. What it offers makes no difference for deadlocks, in which no machine can take a step.
    """
    ahead = [{target for _, target in edges} - {state} for state, edges in enumerate(machine.edges)]
    before: list[list[int]] = [[] for _ in machine.edges]
    for state, targets in enumerate(ahead):
        for target in targets:
            before[target].append(state)
    can_step_alone = [any(event == INTERNAL for event, _ in edges) for edges in machine.edges]
    pending = [state for state, edges in enumerate(machine.edges) if (INTERNAL, state) in edges]
    divergent: set[int] = set()
    while pending:
        state = pending.pop()
        if state not in divergent and can_step_alone[state] and ahead[state] <= divergent:
            divergent.add(state)
            pending += before[state]
    if len(divergent) < 2:
        return machine
    return _with_one(machine, divergent)


def _with_one(machine: Machine, divergent: Collection[int]) -> Machine:
    """The machine with one looping state in place of all these."""
    if 0 in divergent:
        return Machine((((INTERNAL, 0),),), (False,))
    kept = [state for state in range(len(machine.edges)) if state not in divergent]
    number = {state: at for at, state in enumerate(kept)}
    looping = len(kept)
    edges = (
        tuple(dict.fromkeys((event, number.get(target, looping)) for event, target in machine.edges[state]))
        for state in kept
    )
    return Machine((*edges, ((INTERNAL, looping),)), (*(machine.ended[state] for state in kept), False))


class Pairs:
    """Compositions of pairs of machines, each made once. With ``only_deadlocks`` they are equivalent only as to
    deadlocks.
    """

    def __init__(self, limits: Limits, only_deadlocks: bool = False) -> None:
        self._limits = limits
        self._only_deadlocks = only_deadlocks
        self._known: dict[Machine, Machine] = {}
        self._minimal: dict[int, Machine] = {}
        self._made: dict[tuple[int, int, tuple[tuple[int, int], ...], frozenset[int]], Machine] = {}

    def minimal(self, part: MachineInSystem) -> MachineInSystem:
        """The smallest equivalent part."""
        machine = self._same(part.machine)
        if id(machine) not in self._minimal:
            self._minimal[id(machine)] = self._smallest(machine)
        return MachineInSystem(self._minimal[id(machine)], part.events)

    def together(self, one: MachineInSystem, other: MachineInSystem, hidden: Collection[int]) -> MachineInSystem:
        """The minimized parallel composition of both; the hidden events become internal. Raises LimitError and
        TooLargeError.
        """
        place = {event: at for at, event in enumerate(one.events)}
        joints = tuple((place[event], at) for at, event in enumerate(other.events) if event in place)
        events = [*one.events, *(event for event in other.events if event not in place)]
        inside = frozenset(at for at, event in enumerate(events) if event in hidden)
        kept = [at for at in range(len(events)) if at not in inside]
        key = (id(one.machine), id(other.machine), joints, inside)
        if key not in self._made:
            final = {at: new for new, at in enumerate(kept)}
            mine = {at: final.get(at, INTERNAL) for at in range(len(one.events))}
            number = {event: at for at, event in enumerate(events)}
            its = {at: final.get(number[event], INTERNAL) for at, event in enumerate(other.events)}
            product = _product(one.machine, other.machine, joints, mine, its, self._limits)
            self._made[key] = self._smallest(product)
        return MachineInSystem(self._made[key], tuple(events[at] for at in kept))

    def _smallest(self, machine: Machine) -> Machine:
        if self._only_deadlocks:
            machine = with_divergent_states_merged(machine)
        return self._same(minimized(machine, self._limits))

    def _same(self, machine: Machine) -> Machine:
        """The machine that represents all equal ones, so keys can use its identity."""
        return self._known.setdefault(machine, machine)


def _product(
    one: Machine,
    other: Machine,
    joints: Iterable[tuple[int, int]],
    mine: Renamed,
    its: Renamed,
    limits: Limits,
) -> Machine:
    """The reachable product of two machines; ``joints`` are pairs of events that are the same."""
    partner = dict(joints)
    alone = set(its).difference(partner.values())
    numbers = {(0, 0): 0}
    pending = [(0, 0)]
    edges: list[tuple[Edge, ...]] = []
    offers = [_by_event(offered) for offered in other.edges]
    for left, right in pending:
        found: dict[tuple[int, tuple[int, int]], None] = {}
        for event, target in one.edges[left]:
            if event == INTERNAL:
                found[INTERNAL, (target, right)] = None
            elif event not in partner:
                found[mine[event], (target, right)] = None
            else:
                for its_target in offers[right].get(partner[event], ()):
                    found[mine[event], (target, its_target)] = None
        for event, target in other.edges[right]:
            if event == INTERNAL or event in alone:
                found[its.get(event, INTERNAL), (left, target)] = None
        for _, after in found:
            if after not in numbers:
                numbers[after] = len(pending)
                pending.append(after)
        edges.append(tuple((event, numbers[after]) for event, after in found))
        if len(edges) % 1024 == 0:
            limits.check(len(pending) * 1000)
            if len(pending) > MOST_STATES:
                raise TooLargeError
    return Machine(tuple(edges), tuple(one.ended[left] and other.ended[right] for left, right in pending))


def _by_event(edges: Iterable[Edge]) -> dict[int, list[int]]:
    found: dict[int, list[int]] = {}
    for event, target in edges:
        found.setdefault(event, []).append(target)
    return found
