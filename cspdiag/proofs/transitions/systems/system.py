"""A network as communicating state machines: components joined by events, whose product is not built here.

An **event** has parties, the components that must all offer it; it happens when each of them is in a state with an edge
that carries it, and moves them all at once (the synchronization of CSP, Roscoe, "Understanding Concurrent Systems",
chapter 4). Events with a single party are those of the environment and of time: they can happen whenever their party
offers them. ``INTERNAL`` edges belong to one component and carry no event.

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
"""The event of an edge that one component takes by itself, and that no other component sees."""

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
- ``exception``: a branch ends its parallel by ``raise``; ``failure``: by Timeout or Fault, which does not help
  processes that wait for each other
"""


@record
class Event:
    """A step that all its parties take together.

    ``channel`` is the hierarchical name as in traces; ``value`` the value as text, if values of the channel are
    followed. ``visible`` events are those that a specification sees: communications on ports of the outermost process.
    ``instant`` events are ends of delays that may take no time. ``roles`` has a character for each party: ``!`` writes,
    ``?`` reads, ``*`` does something else, ``.`` is not a process; it is empty if the roles are unknown.
    """

    channel: str
    parties: tuple[int, ...]
    kind: EventKind = "communication"
    value: str | None = None
    visible: bool = False
    roles: str = ""
    instant: bool = False

    def role(self, party: int) -> str:
        """The character of a party in ``roles``; empty if unknown."""
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
    """What a process is doing in a state, in words such as ``waits to write fork[1]``; where in the source text; and
    the path of the innermost process that does it.
    """

    uncompared: ClassVar[frozenset[str]] = frozenset()

    words: str
    span: Span | None = None
    path: str = ""


@record
class Component:
    """One state machine: a sequential process, a branch of a parallel composition, a channel with memory, or a shared
    variable.

    ``edges[state]`` are the edges out of a state; ``terminal`` the states in which it has ended. ``places`` describes
    states in words, and may lack some. ``failed`` are those terminal states in which a missed sample has ended it.
    ``process`` says whether it is a process, which can be stuck; a channel or a variable cannot. ``path`` is the path
    of the instance from the outermost process. ``span`` is the source text of a parallel branch that has a number
    instead of a name.
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
    """A decision of the program that the transition system leaves open; a counterexample that depends on it must be
    replayed.
    """

    uncompared: ClassVar[frozenset[str]] = frozenset()

    what: str
    span: Span | None = None


@record
class System:
    """Components and the events that join them. Every component that has an edge with an event is one of its parties.

    An event with a party that has no edge for it never happens: so it is with ``nobody``, the partner on a channel that
    no process uses from the other side. ``terminal`` also contains the states in which a process waits for its
    branches, or to be started: if the program is stuck then, it is because of another component. ``distinctions`` says
    by port how closely the values of inputs are distinguished.
    """

    components: tuple[Component, ...]
    events: tuple[Event, ...]
    abstractions: tuple[Abstraction, ...] = ()
    distinctions: Mapping[str, Distinction] = EMPTY

    @cached_property
    def initial(self) -> tuple[int, ...]:
        """The initial state of every component."""
        return tuple(component.initial for component in self.components)
