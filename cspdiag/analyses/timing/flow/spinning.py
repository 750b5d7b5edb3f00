"""Threads that may run forever while no time passes, together or alone, so nothing else ever runs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from cspdiag.analyses.timing.flow.paths import ChannelSide
from cspdiag.analyses.timing.refusal import Refusal
from cspdiag.analyses.timing.threads.graph import LoopRange, Offer, Place, Thread
from cspdiag.base.graphs import reached, strong_components


class Spinning:
    """Searches for sets of threads that communicate in loops with each other only, and for loops that only compute.

    It starts from all loops that take no time, and drops those that wait for a partner without such a loop, until no
    more can be dropped. A loop that only computes is reported unless it is known to terminate.
    """

    def __init__(self, threads: Sequence[Thread]) -> None:
        self._threads = threads
        self._numbers = {id(thread): k for k, thread in enumerate(threads)}
        self._timed: dict[int, bool] = {}

    def refusals(self) -> list[Refusal]:
        """One for each channel on which threads may communicate forever, and one for each loop that may compute
        forever.
        """
        supplied: dict[ChannelSide, set[int]] | None = None
        while True:
            rounds = {k: list(self._instant_iterations(k, supplied)) for k in range(len(self._threads))}
            found: dict[ChannelSide, set[int]] = {}
            for number, iterations in rounds.items():
                for place, offers in iterations:
                    for end in (*(offer.end for offer in offers), *((net, True) for net in place.sends)):
                        found.setdefault(end, set()).add(number)
            if found == supplied:
                break
            supplied = found
        spinning: dict[str, Refusal] = {}
        for iterations in rounds.values():
            for place, offers in iterations:
                for offer in offers:
                    name = offer.channel.rpartition(".")[2]
                    reason = (
                        f"what communicates on `{name}` may continue forever while no time passes, so nothing else runs"
                    )
                    advice = "let a round of it wait for a sample, an event or a time"
                    spinning.setdefault(offer.channel, Refusal(place.path, reason, place.span, advice))
        return [*spinning.values(), *self._endless(supplied)]

    def _endless(self, supplied: dict[ChannelSide, set[int]]) -> Iterator[Refusal]:
        """The loops that may run forever without waiting or communicating."""
        for number, thread in enumerate(self._threads):
            for loop in thread.loops:
                if self._may_iterate_silently(number, loop, supplied) and not loop.terminates():
                    place = thread.places[loop.header]
                    reason = (
                        "this loop may compute forever while no time passes, so that nothing else runs: nothing shows "
                        "that it ends"
                    )
                    advice = (
                        "let a round of it wait for a sample, an event or a time, or count its rounds up to a constant "
                        "bound"
                    )
                    yield Refusal(place.path, reason, place.span, advice)

    def _may_iterate_silently(self, number: int, loop: LoopRange, supplied: dict[ChannelSide, set[int]]) -> bool:
        """Whether an iteration of a loop may pass without waiting or communicating."""
        reached, pending = {loop.header}, [loop.header]
        while pending:
            for target, offer in self._instant_steps(number, pending.pop(), supplied):
                if target == loop.header and offer is None:
                    return True
                if offer is None and loop.header < target < loop.end and target not in reached:
                    reached.add(target)
                    pending.append(target)
        return False

    def _instant_iterations(
        self, number: int, supplied: dict[ChannelSide, set[int]] | None
    ) -> Iterator[tuple[Place, list[Offer]]]:
        """The places of a thread at which it communicates in a loop that takes no time."""
        thread = self._threads[number]
        edges = {k: self._instant_steps(number, k, supplied) for k in range(len(thread.places))}
        found = strong_components(edges, lambda place: sorted({target for target, _ in edges[place]}))
        for group in found:
            inside = set(group)
            for k in group:
                offers = [offer for target, offer in edges[k] if target in inside and offer is not None]
                is_cycle = len(group) > 1 or any(target == k for target, _ in edges[k])
                if is_cycle and (offers or thread.places[k].sends):
                    yield thread.places[k], offers

    def _instant_steps(
        self, number: int, at: int, supplied: dict[ChannelSide, set[int]] | None
    ) -> list[tuple[int, Offer | None]]:
        """The places that a thread may reach from a place while no time passes, each with the communication for it."""
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
        """Whether some branch of a parallel composition is certain to take time before it ends."""
        thread = self._threads[number]
        group = thread.forks[thread.joins.index(join)]
        return any(self._needs_time(self._numbers[id(branch)]) for branch in group)

    def _needs_time(self, number: int) -> bool:
        if number not in self._timed:
            thread = self._threads[number]
            instantly = reached(
                [thread.entry], lambda at: [target for target, _ in self._instant_steps(number, at, None)]
            )
            ends = (thread.places[k] for k in instantly)
            self._timed[number] = not any(not place.offers and not place.successors for place in ends)
        return self._timed[number]
