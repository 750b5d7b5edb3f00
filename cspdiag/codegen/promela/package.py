"""Networks as Promela models, for SPIN.

The state of every component is a variable, and every event one indivisible step that tests and changes the states of
all its parties. So an event with any number of parties needs no protocol, and SPIN stores exactly the states of the
transition system: one more for each in which everything has ended.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from itertools import product
from math import prod

from cspdiag.codegen.shared.identifiers import distinct
from cspdiag.codegen.shared.models import system_of
from cspdiag.codegen.shared.plain_text import one_line
from cspdiag.codegen.shared.target_error import TargetError
from cspdiag.network.ir.network import CoreNetwork
from cspdiag.proofs.transitions.systems.system import INTERNAL, Component, System

MOST_COMMANDS = 250_000
"""A model of more is refused: SPIN and the C compiler take gigabytes for it, and its text alone some hundreds of
megabytes.
"""

Command = tuple[int, tuple[tuple[int, int, int], ...]]
"""An event, or INTERNAL, and for each of its parties the component with its state before and after."""


def generate(network: CoreNetwork) -> dict[str, str]:
    """The model of a network, by path. Raises TargetError where it would have too many states."""
    text = promela(system_of(network), network.source)
    return {f"{network.name}.pml": text}


def promela(system: System, source: str = "") -> str:
    """The Promela model of a transition system; where SPIN simulates, each command prints its number in
    ``commands(system)``.

    Raises TargetError for one of more than ``MOST_COMMANDS`` commands.
    """
    _refuse_large(system)
    return "".join(f"{line}\n" for line in _lines(system, source))


def commands(system: System) -> list[Command]:
    """All that can happen, by the first component that takes part and its states."""
    offering = [_by_event(component) for component in system.components]
    return [
        (event, moves)
        for index, component in enumerate(system.components)
        for before, edges in enumerate(component.edges)
        for event, after in edges
        for moves in _together(system, offering, event, (index, before, after))
    ]


def numbers_of_commands(system: System) -> dict[int, int]:
    """How many commands each event has, one for each combination of the edges of its parties; of ``INTERNAL`` all
    internal steps.
    """
    offered = [Counter(event for edges in component.edges for event, _ in edges) for component in system.components]
    found = {
        number: prod(offered[party][number] for party in set(event.parties))
        for number, event in enumerate(system.events)
    }
    return found | {INTERNAL: sum(counted[INTERNAL] for counted in offered)}


def _refuse_large(system: System) -> None:
    numbers = numbers_of_commands(system)
    total = sum(numbers.values())
    if total <= MOST_COMMANDS:
        return
    most = max(numbers, key=lambda event: numbers[event])
    of_most = ""
    if most != INTERNAL:
        event = system.events[most]
        of_most = (
            f", {numbers[most]:,} of them for `{event}`, one for each combination of the states of its "
            f"{len(event.parties)} parties"
        )
    raise TargetError(
        f"the Promela model would have {total:,} commands{of_most}; at most {MOST_COMMANDS:,} are written. "
        "`--target cspm` and `cspdiag verify` keep the components apart"
    )


Moves = tuple[tuple[int, int, int], ...]


def _by_event(component: Component) -> dict[int, list[tuple[int, int]]]:
    found: dict[int, list[tuple[int, int]]] = {}
    for before, edges in enumerate(component.edges):
        for event, after in edges:
            found.setdefault(event, []).append((before, after))
    return found


def _together(
    system: System, offering: list[dict[int, list[tuple[int, int]]]], event: int, own: tuple[int, int, int]
) -> Iterator[Moves]:
    """The moves of all parties, when ``own`` is that of the first of them."""
    parties = (own[0],) if event == INTERNAL else system.events[event].parties
    if min(parties) == own[0]:
        others = sorted(set(parties) - {own[0]})
        for moves in product(*(offering[other].get(event, ()) for other in others)):
            yield own, *((other, *move) for other, move in zip(others, moves, strict=True))


def _lines(system: System, source: str) -> Iterator[str]:
    names = distinct((component.name for component in system.components), "s_")
    yield f"/* {_comment(source)}: {len(system.components)} components, {len(system.events)} events."
    yield " * A variable is the state of a component, a command an event: one step of all its parties."
    yield " * spin -a FILE && gcc -O2 -DNOREDUCE -o pan pan.c && ./pan -m1000000 looks for deadlocks. */"
    yield ""
    for name, component in zip(names, system.components, strict=True):
        yield f"{_type(len(component.edges))} {name} = {component.initial}; /* {_comment(component.name)} */"
    yield ""
    yield "active proctype events() {"
    yield "  do"
    for number, (event, moves) in enumerate(commands(system)):
        guard = " && ".join(f"{names[component]} == {before}" for component, before, _ in moves)
        changes = "".join(f"{names[component]} = {after}; " for component, before, after in moves if before != after)
        what = "internal" if event == INTERNAL else _comment(str(system.events[event]))
        yield f'  :: d_step {{ {guard} -> {changes}printf("#{number}\\n") }} /* {what} */'
    ended = [
        f"({' || '.join(f'{name} == {state}' for state in sorted(component.terminal)) or 'false'})"
        for name, component in zip(names, system.components, strict=True)
        if component.process
    ]
    yield f"  :: {' && '.join(ended) or 'true'} -> break /* all have ended */"
    yield "  od"
    yield "}"


def _type(states: int) -> str:
    return "byte" if states <= 256 else "short" if states <= 32768 else "int"


def _comment(text: str) -> str:
    return one_line(text).replace("*/", "* /")
