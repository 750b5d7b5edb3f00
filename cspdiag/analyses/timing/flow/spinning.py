"""Threads that may go on forever while no time passes, with each other or each by itself, so that nothing else ever
runs.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from cspdiag.analyses.timing.flow.paths import ChannelSide
from cspdiag.analyses.timing.refusal import Refusal
from cspdiag.analyses.timing.threads.graph import Circle, Offer, Place, Thread
from cspdiag.base.graphs import reached, strong_components


class Spinning:
    """Looks for sets of threads each of which goes round with communications of the set alone, and for loops that only
    compute.

    From all that may go round at all, those are left out whose partners do not; what is left in the end may spin. A
    loop of computing spins unless it is known to come to its end.
    """

    def __init__(self, threads: Sequence[Thread]) -> None:
        self._threads = threads
        self._numbers = {id(thread): k for k, thread in enumerate(threads)}
        self._timed: dict[int, bool] = {}

    def refusals(self) -> list[Refusal]:
        """One for each channel on which some threads may communicate without end, and for each loop that may compute
        without end.
        """
        supplied: dict[ChannelSide, set[int]] | None = None
        while True:
            rounds = {k: list(self._rounds(k, supplied)) for k in range(len(self._threads))}
            found: dict[ChannelSide, set[int]] = {}
            for number, ways in rounds.items():
                for place, offers in ways:
                    for end in (*(offer.end for offer in offers), *((net, True) for net in place.gives)):
                        found.setdefault(end, set()).add(number)
            if found == supplied:
                break
            supplied = found
        spinning: dict[str, Refusal] = {}
        for ways in rounds.values():
            for place, offers in ways:
                for offer in offers:
                    name = offer.channel.rpartition(".")[2]
                    reason = (
                        f"what communicates on `{name}` may go on forever while no time passes, so that nothing else "
                        "runs"
                    )
                    advice = "let a round of it wait for a sample, an event or a time"
                    spinning.setdefault(offer.channel, Refusal(place.path, reason, place.span, advice))
        return [*spinning.values(), *self._endless(supplied)]

    def _endless(self, supplied: dict[ChannelSide, set[int]]) -> Iterator[Refusal]:
        """The loops that may run forever without waiting or communicating."""
        for number, thread in enumerate(self._threads):
            for circle in thread.circles:
                if self._goes_round_silently(number, circle, supplied) and not circle.ends():
                    place = thread.places[circle.again]
                    reason = (
                        "this loop may compute forever while no time passes, so that nothing else runs: nothing shows "
                        "that it ends"
                    )
                    advice = (
                        "let a round of it wait for a sample, an event or a time, or count its rounds up to a constant "
                        "bound"
                    )
                    yield Refusal(place.path, reason, place.span, advice)

    def _goes_round_silently(self, number: int, circle: Circle, supplied: dict[ChannelSide, set[int]]) -> bool:
        """Whether a round of a loop may go by without waiting or communicating."""
        reached, pending = {circle.again}, [circle.again]
        while pending:
            for target, offer in self._at_once(number, pending.pop(), supplied):
                if target == circle.again and offer is None:
                    return True
                if offer is None and circle.again < target < circle.end and target not in reached:
                    reached.add(target)
                    pending.append(target)
        return False

    def _rounds(self, number: int, supplied: dict[ChannelSide, set[int]] | None) -> Iterator[tuple[Place, list[Offer]]]:
        """The places of a thread at which it communicates on a way back that takes no time."""
        thread = self._threads[number]
        edges = {k: self._at_once(number, k, supplied) for k in range(len(thread.places))}
        found = strong_components(edges, lambda place: sorted({target for target, _ in edges[place]}))
        for group in found:
            inside = set(group)
            for k in group:
                offers = [offer for target, offer in edges[k] if target in inside and offer is not None]
                is_round = len(group) > 1 or any(target == k for target, _ in edges[k])
                if is_round and (offers or thread.places[k].gives):
                    yield thread.places[k], offers

    def _at_once(
        self, number: int, at: int, supplied: dict[ChannelSide, set[int]] | None
    ) -> list[tuple[int, Offer | None]]:
        """Where a thread may go on from a place while no time passes, and by which communication."""
        thread = self._threads[number]
        place = thread.places[at]
        found: list[tuple[int, Offer | None]] = [(target, None) for target in place.successors]
        for offer in place.offers:
            if offer.kind == "partner":
                others = None if supplied is None else supplied.get((offer.channel, not offer.writes), set())
                if others is None or others - {number}:
                    found.append((offer.target, offer))
            elif offer.kind == "join":
                if not self._takes_time(number, at):
                    found.append((offer.target, None))
            elif offer.kind == "delay" and not (offer.period or offer.takes_time):
                found.append((offer.target, None))
        return found

    def _takes_time(self, number: int, join: int) -> bool:
        """Whether some branch of a parallel surely needs time to come to its end."""
        thread = self._threads[number]
        group = thread.forks[thread.joins.index(join)]
        return any(self._needs_time(self._numbers[id(branch)]) for branch in group)

    def _needs_time(self, number: int) -> bool:
        if number not in self._timed:
            thread = self._threads[number]
            at_once = reached([thread.entry], lambda at: [target for target, _ in self._at_once(number, at, None)])
            ends = (thread.places[k] for k in at_once)
            self._timed[number] = not any(not place.offers and not place.successors for place in ends)
        return self._timed[number]
