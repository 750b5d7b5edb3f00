"""Networks in which every component does the same communications over and over, in one order: marked graphs.

The communications are the transitions of a marked graph, and a component is a circle of places among which one has a
token: the one before the communication that it does first. A marked graph is live, so that every communication is
possible again whatever has happened, if no circle of places is without a token, and only then (Commoner, Holt, Even
and Pnueli, "Marked directed graphs", 1971). Then there is neither a deadlock nor a knot.

Of many elements that are connected alike, the places are described once, each with how far apart the elements are
whose communications it is between. Around a circle these distances add up to nothing.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Sequence

from cspdiag.base.graphs import is_circular, strong_components
from cspdiag.base.record import record
from cspdiag.proofs.structure.pairs import Shape
from cspdiag.proofs.transitions.systems.system import INTERNAL


@record
class Place:
    """Places without a token from communications of one kind to those of another; from one element to the next the
    index grows by ``least`` at least, and ``most`` at most.
    """

    before: Hashable
    after: Hashable
    least: int
    most: int


def order_of_events(shape: Shape) -> tuple[int, ...] | None:
    """The events of a component in the order in which it does them, over and over, beginning with its first; None if it
    makes a choice, ends, does something only once, or one event several times.
    """
    order: dict[int, None] = {}
    state = shape.initial
    for _ in shape.edges:  # A circle has no more states than these.
        if len(shape.edges[state]) != 1:
            return None
        ((event, state),) = shape.edges[state]
        if event != INTERNAL and event in order:
            return None
        order[event] = None
        if state == shape.initial:
            break
    order.pop(INTERNAL, None)
    return tuple(order) if state == shape.initial else None


def has_no_circle(places: Iterable[Place]) -> bool:
    """Whether no circle of places can be made of these, each used for any number of elements; False if that is not
    known.
    """
    pending = [list(places)]
    while pending:
        left = pending.pop()
        for inside in _components(left):
            if all(place.least >= 0 for place in inside):
                without = [place for place in inside if place.least == 0]
            elif all(place.most <= 0 for place in inside):
                without = [place for place in inside if place.most == 0]
            else:
                return False
            if len(without) == len(inside):
                return False
            pending.append(without)
    return True


def _components(places: Sequence[Place]) -> list[list[Place]]:
    """The places of each strongly connected component that has some."""
    after: dict[Hashable, list[Hashable]] = {}
    for place in places:
        after.setdefault(place.before, []).append(place.after)

    def following(event: Hashable) -> list[Hashable]:
        return after.get(event, [])

    number: dict[Hashable, int] = {}
    for at, component in enumerate(strong_components(after, following)):
        if is_circular(component, following):
            number.update(dict.fromkeys(component, at))
    found: dict[int, list[Place]] = {}
    for place in places:
        at = number.get(place.before, -1)
        if at >= 0 and number.get(place.after) == at:
            found.setdefault(at, []).append(place)
    return list(found.values())
