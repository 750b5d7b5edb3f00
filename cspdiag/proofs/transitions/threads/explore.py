"""Explores all configurations of a thread and makes a template of them."""

from __future__ import annotations

from cspdiag.proofs.transitions.classes.program import Node
from cspdiag.proofs.transitions.occurrences import Occurrence
from cspdiag.proofs.transitions.systems.labels import Label
from cspdiag.proofs.transitions.systems.minimal import minimized
from cspdiag.proofs.transitions.systems.template import Template
from cspdiag.proofs.transitions.threads import frames
from cspdiag.proofs.transitions.threads.offers import Offers
from cspdiag.proofs.transitions.threads.place_templates import place_template
from cspdiag.proofs.transitions.threads.silent.follow import Follower
from cspdiag.proofs.transitions.threads.thread import Configuration, Restart, Role, Thread

MANY_STATES = 3_000
"""In a thread with more states, the variable with the most values is followed less closely, if any has several."""
MOST_STATES = 200_000
"""A program is refused if a thread has more states."""


class TransitionError(Exception):
    """A program whose transition system cannot be made; the message is one line."""


def explore(occurrence: Occurrence, node: Node | None, role: Role) -> Template:
    """The template of a thread. Raises TransitionError if it has too many states even with all variables left open."""
    thread = Thread(occurrence, node, role)
    while True:
        try:
            return _explored(thread)
        except Restart:
            widened, dropped, unfused = thread.widened, thread.dropped, thread.unfused
            thread = Thread(occurrence, node, role)
            thread.widened, thread.dropped, thread.unfused = widened, dropped, unfused


def _explored(thread: Thread) -> Template:
    follower = Follower(thread)
    offers = Offers(thread, follower)
    template = thread.template
    begin = (
        Configuration((frames.Idle(), None))
        if not thread.role.outermost
        else follower.settled(Configuration(offers.body()))
    )
    numbers: dict[Configuration, int] = {begin: 0}
    order = [begin]
    limit = MANY_STATES
    for configuration in order:
        edges: list[tuple[Label, int]] = []
        seen: set[tuple[Label, int]] = set()
        for label, unsettled in offers.moves(configuration):
            target = follower.settled(unsettled)
            number = numbers.get(target)
            if number is None:
                number = numbers[target] = len(order)
                order.append(target)
                thread.count(target)
            if (label, number) not in seen:
                seen.add((label, number))
                edges.append((label, number))
        template.edges.append(edges)
        if len(order) > limit:
            if thread.give_up(order):
                raise Restart
            limit = MOST_STATES
            if len(order) > MOST_STATES:
                where = thread.root.occurrence.path
                raise TransitionError(f"`{where}` has more than {MOST_STATES} states, whatever is left open")
    for number, configuration in enumerate(order):
        assert configuration.stack is not None
        template.places.append(place_template(thread, configuration))
        if _is_terminal(configuration.stack[0], thread.role):
            template.terminal.add(number)
    _note_widening(thread)
    return minimized(template)


def _is_terminal(frame: frames.Frame, role: Role) -> bool:
    """Whether a thread that does not continue from here is not stuck: it has ended, has not been started, or waits for
    its branches.
    """
    if isinstance(frame, frames.Raised):
        return role.outermost
    return isinstance(frame, frames.Idle | frames.Ended | frames.Over | frames.Faulted | frames.Join)


def _note_widening(thread: Thread) -> None:
    for reference in sorted(thread.widened | thread.dropped, key=str):
        medium = thread.medium(reference)
        name = medium.name.rsplit(".", 1)[-1]
        what = f"of the values of `{name}` only ranges are followed: there are too many"
        if reference in thread.dropped:
            what = f"the values of `{name}` are not followed: there are too many"
        thread.abstracted(what, medium.span)
