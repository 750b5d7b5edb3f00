"""A network as communicating state machines, kept apart: components joined by events, never their product.

An **event** has parties, the components that must all offer it; it happens when each of them is in a state with an edge
that carries it, and moves them all at once (the synchronization of CSP, Roscoe, "Understanding Concurrent Systems",
chapter 4). Events with a single party are those of the environment, of time and of variables: they can happen whenever
their party offers them. ``INTERNAL`` edges belong to one component and carry no event.

A process in a state without edges that is not ``terminal`` never continues (``stop``); in a terminal state it has
ended, which is not a deadlock.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import ClassVar, Literal, TypeAlias

from cspdiag.base import Span
from cspdiag.base.record import EMPTY, record
from cspdiag.proofs.transitions.classes.distinguished import Distinction

INTERNAL = -1
"""The event of an edge that a component takes on its own, unseen."""

Edge: TypeAlias = tuple[int, int]
"""An event (an index into ``System.events``, or ``INTERNAL``) and the state after it."""

EventKind: TypeAlias = Literal[
    "communication", "take", "delivered", "external", "variable", "sample", "miss", "ready", "time",
    "start", "end", "cancel", "exception", "failure",
]  # fmt: skip
"""Kinds of events.

- ``communication``: of two or more processes, or a value that enters a channel with memory; ``take``: it leaves it, or
  is written to a broadcast; ``delivered``: all readers of a broadcast have taken the value (these are the
  communications), or its writer takes it back
- ``external``: with the environment; ``sample`` and ``miss``: a sampled input taken, or found overwritten; ``ready``: a
  guard that an input from outside is ready; ``time``: a delay or time-out
- ``variable``: an access to a shared ``var``
- ``start``, ``end`` and ``cancel``: of a parallel composition, all branches at once
- ``exception``: a branch ends its parallel by ``raise``; ``failure``: by Timeout or Fault, which is no way out for
  processes that wait for each other
"""


@record
class Event:
    """Something that all its parties take part in at once.

    ``channel`` is the hierarchical name as in traces; ``value`` the value as text where values are tracked. ``visible``
    events are those that a specification sees: they pass an external port. ``instant`` is a delay that may be over at
    once, so that no time need pass. ``roles`` says what each party does: ``!`` writes, ``?`` reads, ``*`` something
    else, ``.`` is not a process; empty if unknown.
    """

    channel: str
    parties: tuple[int, ...]
    kind: EventKind = "communication"
    value: str | None = None
    visible: bool = False
    roles: str = ""
    instant: bool = False

    def role(self, party: int) -> str:
        """What a party does, or nothing."""
        position = self.parties.index(party)
        return self.roles[position] if position < len(self.roles) else ""

    def __str__(self) -> str:
        return with_value(self.channel, self.value)


def with_value(channel: str, value: str | None) -> str:
    """The name of an event on a channel, with its value if that is distinguished: ``key.2``, and ``key 3..`` for
    a range.
    """
    if value is None:
        return channel
    return f"{channel} {value}" if ".." in value else f"{channel}.{value}"


@record
class Place:
    """What a process is doing in a state, for people: ``waits to write fork[1]``, where the text says so, and the path
    of the innermost process that does it.
    """

    uncompared: ClassVar[frozenset[str]] = frozenset()

    words: str
    span: Span | None = None
    path: str = ""


@record
class Component:
    """One state machine: a sequential process, a branch of a parallel composition, a channel with memory, or a tracked
    variable.

    ``edges[state]`` are the edges out of a state; ``terminal`` the states in which it has ended. ``places`` describes
    states to people, and may lack some. ``failed`` are those of the terminal states in which a missed sample has ended
    it. ``process`` says whether it is a process that can be stuck: a channel or a variable is not. ``path`` is the
    instance's path from the outermost process. ``span`` is the text of a parallel branch that has no name but its
    number.
    """

    name: str
    edges: tuple[tuple[Edge, ...], ...]
    terminal: frozenset[int] = frozenset()
    initial: int = 0
    places: Mapping[int, Place] = EMPTY
    process: bool = True
    path: str = ""
    failed: frozenset[int] = frozenset()
    span: Span | None = None


@record
class Abstraction:
    """Something that the transition system leaves open although the program decides it; a refutation that depends on it
    must be replayed.
    """

    uncompared: ClassVar[frozenset[str]] = frozenset()

    what: str
    span: Span | None = None


@record
class System:
    """Components and the events that join them. Every component that has an edge with an event is one of its parties.

    A party without an edge for an event never takes part: the event never happens. Such is ``nobody``, the partner on a
    channel that no process uses from the other side. In ``terminal`` are also the states in which a process waits for
    its branches, or to be started: what is stuck then is another component. ``distinctions`` says how the values of
    inputs are distinguished, by port.
    """

    components: tuple[Component, ...]
    events: tuple[Event, ...]
    abstractions: tuple[Abstraction, ...] = ()
    distinctions: Mapping[str, Distinction] = EMPTY

    @cached_property
    def initial(self) -> tuple[int, ...]:
        """The initial state of every component."""
        return tuple(component.initial for component in self.components)
