"""A run of one place of a program: as any other run, but what the other places do arrives as messages."""

from __future__ import annotations

import time
from typing import Any, Final, Literal

from cspdiag.runtime import Network, Process
from cspdiag.runtime.advance.run import NetworkRun
from cspdiag.runtime.channels.broadcast import Broadcast, BroadcastEnd
from cspdiag.runtime.channels.channel import Channel
from cspdiag.runtime.channels.converting import Converting
from cspdiag.runtime.kernel.clock import Clock
from cspdiag.runtime.kernel.durations import END_OF_TIME
from cspdiag.runtime.kernel.exceptions import PartnerLost, RunFailed, described
from cspdiag.runtime.kernel.observer import Observer
from cspdiag.runtime.kernel.party import Party
from cspdiag.runtime.kernel.scheduler import Scheduler
from cspdiag.runtime.kernel.stopping import stopping
from cspdiag.runtime.outcome import Outcome
from cspdiag.runtime.outside.external import Port
from cspdiag.runtime.outside.instants import Environment
from cspdiag.simulate.hosts.division import Division
from cspdiag.simulate.hosts.exchange import Exchange
from cspdiag.simulate.hosts.links import PATIENCE, Links
from cspdiag.simulate.hosts.lost import raise_in_waiting, silence_of
from cspdiag.simulate.hosts.processes import Elsewhere, Here, replace_instances
from cspdiag.simulate.run.probes import parts_of

_LOOK: Final = 0.05
"""Seconds after which a place that waits for messages looks whether it has to stop."""
SILENCE: Final = 5.0
"""Seconds after which a silent place is given up in virtual time, and by those that no channel connects with it."""
_RAISE_AGAIN: Final = 0.1
"""Seconds after which a process that waits again for a lost place gets Timeout again."""


class DividedNetwork(Network):
    """The part of a program that one place runs."""

    def __init__(self, network: Network, division: Division, links: Links) -> None:
        super().__init__(network.process, network.ports, network.parameters)
        assert isinstance(self.process, Process)
        self.division = division
        self.links = links
        self.channels = _channels(self.process)
        self.ended: list[tuple[str, BaseException | None]] = []
        """The instances of this place that have ended, with their exceptions, since the other places were notified."""
        self._awaited = ""
        self._awaited_since = 0.0
        replaced = replace_instances(self.process, self._replacement)
        self.elsewhere = {path: part for path, part in replaced.items() if isinstance(part, Elsewhere)}

    @property
    def awaited(self) -> str:
        """The place that a run in virtual time has been waiting for, to agree with it on the next instant, for longer
        than two places that do so at once; "" for none.
        """
        return self._awaited if time.monotonic() - self._awaited_since > PATIENCE else ""

    def wait_for(self, place: str) -> None:
        """Note that the run waits for a place from now on, if it does not yet; "" for none."""
        if place != self._awaited:
            self._awaited, self._awaited_since = place, time.monotonic()

    def _replacement(self, instance: Process) -> Process:
        place = self.division.place_of_path(instance.name)
        if place == self.division.place:
            return Here(instance, lambda path, error: self.ended.append((path, error)))
        return Elsewhere(instance, place)

    def new_run(
        self,
        scheduler: Scheduler,
        environment: Environment | None,
        clock: Clock,
        until: int | None,
        on_miss: Literal["timeout", "count"],
        observer: Observer | None,
    ) -> NetworkRun:
        """See ``Network.new_run``."""
        return DividedRun(self, scheduler, environment, clock, until, on_miss, observer)


def _channels(process: Process) -> dict[str, Channel[Any] | Broadcast[Any]]:
    """The channels of a process and of all processes in it, by name."""
    found = {}
    for part in parts_of(process):
        end = part.end if isinstance(part, Converting) else part
        channel = end.channel if isinstance(end, BroadcastEnd) else end
        if isinstance(channel, Channel | Broadcast):
            found[channel.name] = channel
    return found


class DividedRun(NetworkRun):
    """One run of the part of a place."""

    _network: DividedNetwork

    def __init__(
        self,
        network: DividedNetwork,
        scheduler: Scheduler,
        environment: Environment | None,
        clock: Clock,
        until: int | None,
        on_miss: Literal["timeout", "count"],
        observer: Observer | None,
    ) -> None:
        super().__init__(network, scheduler, environment, clock, until, on_miss, observer)
        self._division = network.division
        self._links = network.links
        self._exchange = Exchange(network, scheduler, real_time=clock.real)
        self._raise_again = 0.0

    def _own_ports(self) -> tuple[Port, ...]:
        own = self._network.division.own_ports
        return tuple(port for port in self._network.ports if port.name in own)

    # The run

    def outcome(self) -> Outcome:
        """The run, after which the other places are notified that it is over."""
        outcome = super().outcome()
        why = {"stopped": "it was stopped", "deadlock": "a deadlock"}.get(outcome.ended, outcome.ended)
        if outcome.error is not None:
            why = described(outcome.error)
        end = (self._division.place, why)
        if isinstance(outcome.error, PartnerLost) and self._exchange.first_end is not None:
            end = self._exchange.first_end
        outcome.links = self._links.report()
        self._links.broadcast(("bye", outcome.ended, *end))
        return outcome

    def _observe(self) -> None:
        super()._observe()
        observe = self._scheduler.observe
        if observe is None:
            return
        crossings = self._exchange.crossings.paths

        def observe_here(channel: str, value: Any, writer: Party | None, reader: Party | None) -> None:
            if reader is not None or channel not in crossings:  # The place of the reader shows the communication.
                observe(channel, value, writer, reader)

        self._scheduler.observe = observe_here

    def start(self) -> None:
        """See ``NetworkRun.start``; in real time all places begin together."""
        super().start()
        self._links.news = self._clock.notify
        if self._clock.real:
            self._links.broadcast(("ready",))
            while not self._exchange.are_ready(self._exchange.present):
                self._wait_for_messages()
                self._exchange.receive()
            self._clock.start()

    def _wait_for_messages(self) -> None:
        """Waits for a while. Raises RunFailed if there is no hope."""
        self._links.wait(_LOOK)
        stopping.check()
        self._give_up_if_doomed()
        for link in self._links.lost:
            if time.monotonic() - link.answered > SILENCE:
                raise RunFailed(PartnerLost(f"the place `{link.place}` has been silent for {SILENCE:g} s"))

    def _give_up_if_doomed(self) -> None:
        """Raises RunFailed if another place has ended; what it has sent before comes first, as an exception."""
        if self._exchange.doom is not None and not any(self._exchange.rounds.values()):
            raise RunFailed(self._exchange.doom)

    def _ended_by_itself(self) -> Outcome:
        self._exchange.collect()
        for other in self._exchange.present:
            self._exchange.send_round(other, active=True) if not self._clock.real else self._exchange.flush(other)
        return super()._ended_by_itself()

    # In virtual time: in lock-step

    def _in_virtual_time(self) -> Outcome:
        """All places agree on each instant, which is the next one of any of them, when nothing happens at the present
        one any more. What one sends to the others in a round happens there in the next.
        """
        scheduler, timers, instants = self._scheduler, self._scheduler.timers, self._instants
        until = END_OF_TIME if self._until is None else min(self._until, END_OF_TIME)
        last = self._last_instant(until)
        while True:
            while scheduler.run_ready():
                stopping.check()
            stopping.check()
            if self._root.ended:
                return self._ended_by_itself()
            self._give_up_if_doomed()
            timer = timers.next_instant()
            can_continue = timer is not None or instants.port_can_have_effect()
            following = [instant for instant in (timer, instants.after(scheduler.now)) if instant is not None]
            instant = self._agree(min(following, default=None), can_continue=can_continue)
            if instant == scheduler.now:
                continue
            if instant is None:
                return self._deadlocked()
            if instant > last:
                if instant > until:
                    return self._limit_reached(until)
                self._change_parameters(instant)
                last = self._last_instant(until)
            scheduler.now = instant
            instants.meet(instant)
            timers.fall_due(instant)

    def _agree(self, following: int | None, *, can_continue: bool) -> int | None:
        """Ends a round with all places; returns the instant at which the next one is, None: nowhere can anything
        happen.
        """
        active = self._exchange.collect()
        for other in self._exchange.present:
            self._exchange.send_round(other, active=active, following=following, can_continue=can_continue)
        votes = [(active, following, can_continue)]
        for other in self._division.others:
            while not self._exchange.rounds[other] and not self._links.by_place[other].over:
                self._exchange.receive()
                if not self._exchange.rounds[other] and not self._links.by_place[other].over:
                    self._network.wait_for(other)
                    self._wait_for_messages()
            self._network.wait_for("")
            if self._exchange.rounds[other]:
                *vote, items = self._exchange.rounds[other].popleft()
                votes.append(tuple(vote))
                self._exchange.apply(other, items)
        if any(is_active for is_active, _, _ in votes):
            return self._scheduler.now
        if not any(can for _, _, can in votes):
            return None
        return min(instant for _, instant, _ in votes if instant is not None)

    # In real time

    def _stepped(self) -> None:
        self._exchange.collect()
        for other in self._exchange.present:
            self._exchange.flush(other)

    def _has_news(self) -> bool:
        return super()._has_news() or self._exchange.has_news

    def _take_over(self, instant: int | None) -> None:
        super()._take_over(instant)
        self._exchange.apply_arrived()
        if self._links.lost and time.monotonic() >= self._raise_again:
            self._raise_again = time.monotonic() + _RAISE_AGAIN
            self._exchange.standstill.disturbed()
            for link in self._links.lost:
                self._exchange.crossings.hand_back(link.place)
                if self._division.talks_to(link.place):
                    waiting = self._exchange.crossings.waiting_for(link.place)
                    raise_in_waiting(self._root, waiting, silence_of(link.place, PATIENCE))
                elif time.monotonic() - link.answered > SILENCE:
                    self._end_parts_of(link.place)

    def _end_parts_of(self, place: str) -> None:
        """Only the parallel composition waits for the processes of that place: it cannot continue without them."""
        for part in self._network.elsewhere.values():
            if part.place == place:
                part.end(silence_of(place, SILENCE))

    def _can_continue(self) -> bool:
        if self._exchange.doom is not None:
            raise RunFailed(self._exchange.doom)
        is_idle = not (super()._can_continue() or self._can_receive())
        if not is_idle:
            self._exchange.standstill.disturbed()
        if self._exchange.deadlock is None:
            is_alone = not self._division.others
            return not (is_idle and (is_alone or self._exchange.standstill.is_everywhere(self._scheduler.now)))
        if is_idle:
            return False
        raise RunFailed(self._exchange.deadlock)

    def _deadlocked(self) -> Outcome:
        if not (self._clock.real and self._division.others):
            return super()._deadlocked()
        # The clock has gone on since then, but nothing else.
        return self._deadlocked_since(self._exchange.standstill.instant)

    def _can_receive(self) -> bool:
        """Whether something else than a new message of another place can have an effect here or there."""
        return bool(self._exchange.limit_is_reached or self._has_news() or self._exchange.has_new_signals)
