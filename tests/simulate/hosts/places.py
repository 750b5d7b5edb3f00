"""Places of a program in threads of one process, with a network between them that loses and delays on request."""

from __future__ import annotations

import random
import threading
import time
from collections.abc import Callable, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from functools import partial

from cspdiag import pipeline
from cspdiag.base.sources import read_source
from cspdiag.base.span import SourceFile
from cspdiag.simulate.hosts.links import Transport
from cspdiag.simulate.hosts.part import Part, Seat
from cspdiag.simulate.record.recorder import Recorder
from cspdiag.simulate.result import Run
from cspdiag.simulate.run.execute import chosen_environment, simulate


class Air:
    """Brings bytes between transports; loses a part of them, and delays the others by up to ``delay`` seconds. What is
    sent while it is cut is lost or, if it ``keeps`` frames, brought in order when it works again.
    """

    def __init__(self, *, loss: float = 0.0, delay: float = 0.0) -> None:
        self.loss = loss
        self.delay = delay
        self.is_cut = False
        self.cut_to: set[str] = set()
        """Places that nothing reaches, while what they send arrives."""
        self.keeps = False
        self.count = 0
        """The number of frames that were sent."""
        self._random = random.Random(1)
        self._kept: list[tuple[str, bytes]] = []
        self._receivers: dict[str, list[Callable[[bytes], None]]] = {}

    def transport(self) -> Transport:
        """A transport of a place."""
        return _AirTransport(self)

    def join(self, place: str, arrived: Callable[[bytes], None]) -> None:
        """Someone hears what is sent to a place."""
        self._receivers.setdefault(place, []).append(arrived)

    def leave(self, arrived: Callable[[bytes], None]) -> None:
        """Someone hears nothing any more."""
        for receivers in self._receivers.values():
            if arrived in receivers:
                receivers.remove(arrived)

    def send(self, place: str, data: bytes) -> None:
        """Bring the bytes to all who hear the place, perhaps."""
        self.count += 1
        if self.is_cut or place in self.cut_to:
            if self.keeps:
                self._kept.append((place, data))
            return
        if self._random.random() < self.loss:
            return
        delay = self._random.random() * self.delay
        for arrived in list(self._receivers.get(place, [])):
            # From another thread, as from a network.
            timer = threading.Timer(delay, arrived, [data])
            timer.daemon = True
            timer.start()

    def restore(self) -> None:
        """Bring what was kept, and then what is sent from now on."""
        kept, self._kept = self._kept, []
        for place, data in kept:
            for arrived in list(self._receivers.get(place, [])):
                arrived(data)
            time.sleep(0.001)  # So that the program runs in between.
        self.is_cut = False
        self.cut_to.clear()


class _AirTransport:
    def __init__(self, air: Air) -> None:
        self._air = air
        self._arrived: Callable[[bytes], None] | None = None

    def open(self, place: str, arrived: Callable[[bytes], None]) -> None:
        self._arrived = arrived
        self._air.join(place, arrived)

    def send(self, place: str, data: bytes) -> None:
        self._air.send(place, data)

    def close(self) -> None:
        if self._arrived is not None:
            self._air.leave(self._arrived)


def run_place(
    text: str,
    place: str,
    air: Air,
    *,
    program: Mapping[str, str] | None = None,
    until: int | None = None,
    real_time: bool = False,
) -> Run:
    """One place of a program, in this thread. Raises PlaceError."""
    built = pipeline.build(SourceFile(name="program.csp", text=text), read_source, alone=True)
    network = built.network
    assert network is not None, built.checked.report.diagnostics
    environment = chosen_environment(network, None)
    assert environment is not None
    seat = Seat(place, "127.0.0.1:1")
    part = Part(network, environment, seat, program or {}, lambda listens: air.transport(), lambda said: None)
    files = pipeline.generate(network, read_source, level=0, traced=True, observed=True)
    try:
        return simulate(network, files, until=until, real_time=real_time, recorder=Recorder(), part=part.network)
    finally:
        part.close()


def begin(pool: ThreadPoolExecutor, text: str, place: str, air: Air, **options: object) -> Future[Run]:
    """The same in a thread of its own."""
    return pool.submit(partial(run_place, text, place, air, **options))  # type: ignore[arg-type]


def trace(*runs: Run) -> list[str]:
    """What has passed in all runs together, in the order of the texts."""
    return sorted(
        f"{time_} {channel} {value!r} {writer} {reader}"
        for run in runs
        for time_, channel, value, writer, reader in run.communications
    )


def eventually(condition: Callable[[], bool], seconds: float = 20.0) -> bool:
    """Whether something becomes true."""
    until = time.monotonic() + seconds
    while not condition() and time.monotonic() < until:
        time.sleep(0.01)
    return condition()
