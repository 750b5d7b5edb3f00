"""Follows the communications of a run through a transition system: the system allows whatever the program does, and
ends as it ends.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import product
from typing import Any

from cspdiag.model.types import Type
from cspdiag.network.dump.expression import value_text
from cspdiag.network.ir.network import Network
from cspdiag.proofs.transitions.systems.system import INTERNAL, Event, System
from cspdiag.settings import parse_duration

Communication = tuple[str, str]
"""The channel and the value that passed, as text."""

State = tuple[int, ...]

OBSERVED = frozenset({"communication", "external", "sample"})
"""The kinds of events that are in the trace of a run."""

_GIVEN = frozenset({"external", "sample", "miss", "ready"})
"""The kinds of events that may wait for the environment, forever."""


class Lost(Exception):  # noqa: N818
    """The system does not allow what the program did."""


def moves(system: System, state: State) -> Iterator[tuple[int, State]]:
    """All steps from a state: the event, or INTERNAL, and the state after it."""
    offers: dict[int, dict[int, list[int]]] = {}
    for number, (component, local) in enumerate(zip(system.components, state, strict=True)):
        for event, target in component.edges[local]:
            if event == INTERNAL:
                yield INTERNAL, (*state[:number], target, *state[number + 1 :])
            else:
                offers.setdefault(event, {}).setdefault(number, []).append(target)
    for event, of in offers.items():
        if len(of) == len(system.events[event].parties):
            for targets in product(*of.values()):
                after = list(state)
                for number, target in zip(of, targets, strict=True):
                    after[number] = target
                yield event, tuple(after)


def has_ended(system: System, state: State) -> bool:
    """Whether every process has reached its end, or waits for others that have."""
    return all(
        local in component.terminal or not component.process
        for component, local in zip(system.components, state, strict=True)
    )


def is_stuck(system: System, state: State) -> bool:
    """Whether nothing more happens unless the environment offers something, and not every process has ended."""
    waiting = all(event != INTERNAL and system.events[event].kind in _GIVEN for event, _ in moves(system, state))
    return waiting and not has_ended(system, state)


def observed(network: Network, communications: Iterable[tuple[str, Any]]) -> tuple[list[Communication], set[str]]:
    """The communications of a run, channels with values, except those of sampled outputs, and the names of these.

    A sampled output communicates at the next tick; in the system it is an event where it is written.
    """
    types = _types(network)
    latched = {
        f"{network.top}.{port.name}"
        for port in network.external_ports
        if port.direction == "out" and port.sampling is not None and not port.immediate
    }
    return [
        (channel, value_text(value, types[channel])) for channel, value in communications if channel not in latched
    ], latched


def _types(network: Network) -> dict[str, Type]:
    types = {net.path: net.type for net in network.nets}
    return types | {f"{network.top}.{port.name}": port.type for port in network.external_ports}


def is_written_as(value: str, reported: str | None) -> bool:
    """Whether a value that passed is one of those that an event represents."""
    if reported is None or ".." not in reported:
        return reported in (None, value)
    number, *ends = (_number(text) for text in (value, *reported.split("..")))
    assert number is not None
    low, high = ends
    return (low is None or low <= number) and (high is None or number <= high)


def _number(text: str) -> int | None:
    if not text:
        return None
    return int(text) if text.lstrip("-").isdecimal() else parse_duration(text)


def _readers(system: System, event: Event) -> int:
    """How many communications of the trace an event represents: an output guard on a broadcast serves all readers at
    once.
    """
    processes = sum(system.components[party].process for party in event.parties)
    return processes - 1 if event.kind == "communication" and processes > 2 else 1


def follow(
    system: System,
    communications: Sequence[Communication],
    unseen: set[str],
    condition: Callable[[System, State], bool] = lambda _system, _state: True,
    limit: int = 60_000,
) -> State | None:
    """A state after the communications, at which ``wanted`` holds; None if ``limit`` states were not enough to find
    one.

    Communications of the channels ``unseen`` are ignored. Raises Lost, with what could not be followed, if there is no
    such state.
    """
    start = (system.initial, 0)
    seen = {start}
    pending = [(0, 0, 0, start)]
    furthest = 0
    while pending:
        _, silent, _, (state, done) = heapq.heappop(pending)
        furthest = max(furthest, done)
        if done == len(communications) and condition(system, state):
            return state
        for event, after in moves(system, state):
            step = done
            known = None if event == INTERNAL else system.events[event]
            if known is not None and known.kind in OBSERVED and known.channel not in unseen:
                step += _readers(system, known)
                if step > len(communications) or not all(
                    known.channel == channel and is_written_as(value, known.value)
                    for channel, value in communications[done:step]
                ):
                    continue
            following = (after, step)
            if following not in seen:
                seen.add(following)
                if len(seen) > limit:
                    return None
                heapq.heappush(pending, (-step, 0 if step > done else silent + 1, len(seen), following))
    what = communications[furthest] if furthest < len(communications) else "the way in which it ended"
    raise Lost(f"after {furthest} of {len(communications)} communications: {what}")
