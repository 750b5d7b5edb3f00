"""Ports of the outermost process: where a program meets its environment.

A *sampled* port communicates at the instants k·period + offset. A sampled output is a latch for one value, which is
handed to the driver at the tick: that is when it communicates. Any other output communicates when it is written.
Inputs: see ``inputs``.
"""

from __future__ import annotations

from collections.abc import Generator, Iterable
from math import isfinite
from types import coroutine
from typing import Any, Generic, TypeAlias

from ..channels.ports import Out, T
from ..channels.selector import Selector
from ..kernel.exceptions import Cancelled, Fault
from ..kernel.party import Party
from ..kernel.scheduler import present
from .drivers import Driver
from .event_inputs import EventInput
from .sampled_inputs import SampledInput
from .supply import Supply
from .ticks import Ticks


class _ExternalOutput(Out[T]):
    """An output of the outermost process; any number of processes may write it, one after the other."""

    __slots__ = ("driver", "line", "name", "safe")

    @property
    def can_have_effect(self) -> bool:
        """Whether a value will be handed over at a tick."""
        return False

    def __init__(self, name: str, driver: Driver | None, safe: T | None) -> None:
        self.name = name
        self.driver = driver
        self.line: Any = driver
        self.safe = safe

    def _hand_over(self, value: T, writer: Party | None) -> None:
        if self.line is not None:
            self.line.write(value)
        scheduler = present()
        if scheduler.port_logs:
            scheduler.note(self.name, value)
        if scheduler.observe is not None:
            scheduler.observe(self.name, value, writer, None)

    def withdraw(self, party: Party) -> bool:
        """See ``Out.withdraw``: no party waits here."""
        return False

    def watch_output(self, selector: Selector, bit: int) -> None:
        """See ``Out.watch_output``: always ready."""
        selector.ready |= bit

    def unwatch_output(self, selector: Selector) -> None:
        """See ``Out.unwatch_output``."""


class SampledOutput(_ExternalOutput[T], Generic[T]):
    """A sampled output: the last value written in a period is handed over at its tick, or at once if ``immediate``."""

    __slots__ = ("has_ticks", "immediate", "latched", "ticks", "writer", "written")

    def __init__(
        self,
        name: str,
        *,
        period: int,
        offset: int = 0,
        driver: Driver | None = None,
        safe: T | None = None,
        immediate: bool = False,
    ) -> None:
        super().__init__(name, driver, safe)
        self.ticks = Ticks(period, offset)
        self.has_ticks = not immediate
        self.immediate = immediate or isinstance(driver, Supply)
        self.written = False
        self.latched: Any = None
        self.writer: Party | None = None

    @coroutine
    def write(self, value: T, /) -> Generator[None, None, None]:
        """See ``Out.write``: the same in fewer steps for a number that is latched."""
        scheduler = present()
        if self.immediate or scheduler.policy is not None or not isinstance(value, float) or not isfinite(value):
            yield from super().write(value)
            return
        task = scheduler.current
        if task.cancelled:
            raise Cancelled
        self.latched = value
        self.writer = task
        self.written = True

    def offer(self, party: Party, value: T, /) -> bool:
        """See ``Out.offer``. Raises Fault for a NaN or an infinity."""
        if not isinstance(value, float) or not isfinite(value):
            _require_finite(self.name, value)
        if self.immediate:
            self._hand_over(value, party)
        else:
            self.latched = value
            self.writer = party
            self.written = True
        policy = present().policy
        if policy is not None:
            policy.wrote(party, self.name, value)
        return True

    @property
    def can_have_effect(self) -> bool:
        """Whether a value will be handed over at a tick."""
        return self.written

    def tick(self) -> None:
        """Hands over what was written since the last tick."""
        if self.written:
            self.written = False
            self._hand_over(self.latched, self.writer)


class EventOutput(_ExternalOutput[T], Generic[T]):
    """An event output: every value goes to the driver at once."""

    __slots__ = ()

    def __init__(self, name: str, *, driver: Driver | None = None, safe: T | None = None) -> None:
        super().__init__(name, driver, safe)

    def offer(self, party: Party, value: T, /) -> bool:
        """See ``Out.offer``. Raises Fault for a NaN or an infinity."""
        _require_finite(self.name, value)
        self._hand_over(value, party)
        policy = present().policy
        if policy is not None:
            policy.wrote(party, self.name, value)
        return True


Port: TypeAlias = "SampledInput[Any] | SampledOutput[Any] | EventInput[Any] | EventOutput[Any]"
"""A port of the outermost process."""


def _require_finite(port: str, value: object) -> None:
    if type(value) is float:
        if not isfinite(value):
            raise Fault(f"{value} is written to {port}")
    elif isinstance(value, tuple | list):
        for part in value:
            _require_finite(port, part)
    else:
        fields: Iterable[str] = getattr(value, "__dataclass_fields__", ())
        for field in fields:
            _require_finite(port, getattr(value, field))
