"""Alternatives and interrupts: requests that wait for whichever of several guards is ready first."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from cspdiag.semantics.media import Offer
from cspdiag.semantics.outside import begin_sessions
from cspdiag.semantics.requests import CancelledError, Request, Steps, Task, no_steps
from cspdiag.semantics.values import RaisedError


class Choose(Request):
    """An alternative; the result is the index of a guard and its value. «Alternative», «Guards»

    It has ``offers`` by guard, ``timeouts`` with their instants, and guards that are ``always`` ready. ``memory`` keeps
    the guard that was chosen last; ``place`` is the number of the alternative in the order of the program.
    """

    def __init__(self, prioritized: bool, memory: dict[str, int], place: int) -> None:
        super().__init__()
        self.prioritized = prioritized
        self.memory = memory
        self.place = place
        self.offers: dict[int, Offer] = {}
        self.timeouts: dict[int, int] = {}
        self.always: set[int] = set()
        self.chosen: int | None = None
        self.parked = False
        self.bound = False
        """Whether its value waits as that of a writer, for a process that is going to read it."""
        self.promised = False
        """Whether that value has been taken."""
        self.interrupt: Interrupt | None = None

    @property
    def turn(self) -> tuple[int, int]:
        """Alternatives are served in the order of the program. «Parties, channels and guards»"""
        return (1, self.place)

    def ready_guards(self) -> list[int]:
        """The guards that are ready now, in text order. «Guards»"""
        ready = set(self.always)
        ready.update(index for index, offer in self.offers.items() if offer.medium.ready(offer))
        ready.update(index for index, deadline in self.timeouts.items() if deadline <= self.world.due)
        return sorted(ready)

    def can_continue(self) -> bool:
        """Whether it has not chosen, and a guard is ready."""
        return self.chosen is None and bool(self.ready_guards())

    def attempt(self) -> None:
        """Choose among the guards that are ready now, or wait. «Alternative»"""
        if self.chosen is not None:
            return
        ready = self.ready_guards()
        if not ready:
            self.park()
            return
        index = ready[0] if self.prioritized else self.world.fair(ready, self.memory.get("last", -1))
        self._settle(index)
        offer = self.offers.get(index)
        if offer is None:
            self.finish((index, None))
            return
        offer.medium.choose(offer)
        if offer.done:
            self.finish((index, offer.value))

    def park(self) -> None:
        """Begin to wait: the guards wait at their channels like readers and writers, and sessions begin. «Alternative»,
        «Time»
        """
        if not self.parked:
            self.parked = True
            begin_sessions(list(self.offers.values()))
            for offer in self.offers.values():
                offer.medium.park(offer)
            self.world.notice()

    def _settle(self, index: int) -> None:
        self.chosen = index
        if self.interrupt is not None and not self.interrupt.body.ended:
            self.interrupt.trigger()
        self.memory["last"] = index
        for offer in self.offers.values():
            offer.medium.withdraw(offer)

    def resolve(self, offer: Offer) -> None:
        """The other side has chosen this guard, and communicates with it. «Parties, channels and guards»"""
        assert offer.guard is not None
        self._settle(offer.guard)
        if offer.only_ready:
            self.finish((self.chosen, None))

    def bind(self, offer: Offer) -> None:
        """A ready guard of another process has chosen this output guard: the value waits as that of a writer.

        «Parties, channels and guards»
        """
        assert offer.guard is not None
        self._settle(offer.guard)
        offer.guard = None
        offer.medium.arrive(offer)
        self.bound = True

    def offer_done(self, offer: Offer) -> None:
        """The communication of the chosen guard has taken place."""
        if self.interrupt is not None and self.bound:
            self.promised = True
            self.world.make_ready(self.world.start(no_steps(), self.task.priority, Promise(self.interrupt)))
        else:
            self.finish((self.chosen, offer.value))

    def finish(self, result: Any = None) -> None:
        """The guard of an interrupt waits for the end of the body. «Interrupt» 2"""
        if self.interrupt is None or self.interrupt.body.ended:
            super().finish(result)
        else:
            self.done, self.result = True, result

    def offers_now(self) -> Sequence[Offer]:
        """The offers of all guards until one is chosen, then that of the chosen one until it has communicated."""
        if self.chosen is None:
            return list(self.offers.values())
        return [offer for index, offer in self.offers.items() if index == self.chosen and not offer.done]

    def deadlines(self) -> Sequence[int]:
        """The instants of its time-outs."""
        return list(self.timeouts.values()) if self.chosen is None else ()

    def abandon(self) -> None:
        """Withdraw the guards. «Cancellation» 1"""
        for offer in self.offers.values():
            offer.medium.withdraw(offer)
        super().abandon()


class Promise:
    """The writer of a value that a reader took from the guard of an interrupt before the interrupted process ran again.

    It has a turn of its own. «Interrupt» 5
    """

    def __init__(self, interrupt: Interrupt) -> None:
        self.interrupt = interrupt

    def branch_ended(self, task: Task, error: RaisedError | None) -> None:
        """Its turn: the process continues, if it waits for nothing else."""
        guard, process = self.interrupt.guard, self.interrupt.task
        guard.done, guard.result = True, (guard.chosen, None)
        if self.interrupt.body.ended and not process.ended and process not in self.interrupt.world.ready:
            self.interrupt.world.run_next(process)


class Interrupt(Request):
    """A body that is abandoned once ``guard`` is ready.

    The result is that of the guard, or None if the body has ended by itself. «Interrupt»

    The guard waits in parallel with the body, as an alternative: another alternative may choose to communicate with it.
    """

    def __init__(self, body: Steps, guard: Choose) -> None:
        super().__init__()
        self.body_steps = body
        self.guard = guard
        self.triggered = False
        self.alone = False
        """Whether the body was abandoned, and the process is now an alternative with this guard alone."""

    @property
    def turn(self) -> tuple[int, int]:
        """Guards of interrupts come last, in the order in which they began. «Parties, channels and guards»"""
        return (2, self.began)

    def begin(self) -> None:
        """The body enters the ready queue, then the guard begins to wait in parallel with it. «Interrupt» 1 and 2"""
        self.guard.task, self.guard.world, self.guard.began = self.task, self.world, self.began
        self.guard.interrupt = self
        self.body = self.world.start(self.body_steps, self.task.priority, self)
        self.world.make_ready(self.body)
        self.guard.park()
        if self.can_continue():
            self.trigger()

    @property
    def completed(self) -> bool:
        """Whether the body has ended, and the communication of the guard has taken place if it was chosen."""
        return self.done or (self.guard.done and self.body.ended)

    @property
    def branches_run(self) -> bool:
        """Whether the body, or the writer of a promised value, has not ended."""
        return not self.body.ended or (self.guard.promised and not self.guard.done)

    def can_continue(self) -> bool:
        """Whether the guard is ready for the first time, or again after the body has ended. «Interrupt» 2 and 4"""
        return (self.body.ended or not self.triggered) and self.guard.can_continue()

    def wake(self) -> None:
        """The guard is ready."""
        if self.body.ended:
            super().wake()
        else:
            self.trigger()

    def trigger(self) -> None:
        """The guard is ready, or was chosen by the other side: the body is cancelled at that moment. «Interrupt» 2"""
        self.triggered = True
        self.world.cancel(self.body)

    def branch_ended(self, task: Task, error: RaisedError | None) -> None:
        """The body has ended, by itself or because it was cancelled. «Interrupt» 3 and 4"""
        abandoned = isinstance(error, CancelledError)
        if (self.guard.chosen is not None and (error is None or abandoned)) or (
            abandoned and self.triggered and not self.task.cancelled
        ):
            self.world.make_ready(self.task)
        else:
            self._withdraw_guard()
            self.error = error
            self.finish()

    def _withdraw_guard(self) -> None:
        for offer in self.guard.offers.values():
            offer.medium.withdraw(offer)

    def attempt(self) -> None:
        """The process is now an alternative with this guard alone, which begins now. «Interrupt» 4"""
        if not self.body.ended or self.done or self.guard.chosen is not None:
            return
        if self.guard.parked and not self.alone:
            self.alone, self.guard.parked = True, False
            self._withdraw_guard()
            self.world.begun += 1
            self.began = self.guard.began = self.world.begun
        self.guard.attempt()

    def outcome(self) -> Any:
        """The guard and its value; None if the body ended by itself."""
        return self.guard.result if self.guard.done else None

    def offers_now(self) -> Sequence[Offer]:
        """The offers of the guard."""
        return self.guard.offers_now()

    def deadlines(self) -> Sequence[int]:
        """The instant of the time-out of the guard."""
        return () if self.triggered and not self.body.ended else self.guard.deadlines()

    def abandon(self) -> None:
        """Withdraw the guard and cancel the body. «Cancellation» 2"""
        self._withdraw_guard()
        if self.body.ended:
            super().abandon()
        else:
            self.world.cancel(self.body)
