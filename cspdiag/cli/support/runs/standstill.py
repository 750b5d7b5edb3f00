"""Prints one line on standard error if simulated time stands still while a program runs."""

from __future__ import annotations

import threading
import time
from collections.abc import Sequence
from types import TracebackType
from typing import TYPE_CHECKING, Protocol

from cspdiag.base.standard_streams import standard_error
from cspdiag.cli.support.terminal import put
from cspdiag.runtime.kernel.places import whereabouts
from cspdiag.runtime.kernel.signals import left_to_the_main_thread

if TYPE_CHECKING:
    from cspdiag.simulate.record.recorder import Recorder


class RunningNetwork(Protocol):
    """A network that runs in a thread of this process."""

    @property
    def now(self) -> int:
        """The present instant in nanoseconds."""
        ...

    @property
    def over(self) -> bool:
        """Whether nothing is simulated any more; how the run ended may still be computed."""
        ...


class ObservedProgram(RunningNetwork, Protocol):
    """A running program that knows which of its processes are running."""

    def running_processes(self) -> list[str]:
        """Processes that were found running, each with its place."""
        ...


class RunningPlace(RunningNetwork, Protocol):
    """The network of a place that runs; see ``DividedNetwork``."""

    @property
    def awaited(self) -> str:
        """The other place that it waits for; "" for none."""
        ...


PATIENCE = 3.0
"""Seconds between two observations."""
_SAMPLES = 20
"""The number of samples taken: between two steps no process runs, and several may alternate."""
_SECONDS_BETWEEN_SAMPLES = 0.005
_MOST_PLACES = 3
_MOST_NAMES = 4


class ProgramInThread:
    """A network that runs in the thread that creates this object."""

    def __init__(self, network: RunningNetwork) -> None:
        self._network = network
        self._scheduler = threading.get_ident()

    @property
    def now(self) -> int:
        """The present instant in nanoseconds."""
        return self._network.now

    @property
    def over(self) -> bool:
        """Whether nothing is simulated any more; how the run ended may still be computed."""
        return self._network.over

    def running_processes(self) -> list[str]:
        """Processes that are found running during a tenth of a second, each with its line."""
        found: dict[str, None] = {}
        for _ in range(_SAMPLES):
            if place := whereabouts(self._scheduler, only_processes=True):
                found[place] = None
            if len(found) == _MOST_PLACES:
                break
            time.sleep(_SECONDS_BETWEEN_SAMPLES)
        return list(found)


class ProgramInPlace(ProgramInThread):
    """The part of a program that one place runs, in the thread that creates this object."""

    def __init__(self, network: RunningPlace) -> None:
        super().__init__(network)
        self._place = network

    @property
    def awaited(self) -> str:
        """The other place that it waits for; "" for none."""
        return self._place.awaited


class Standstill:
    """Observes the time of a run in virtual time from a thread of its own, so the run is not slowed down.

    Used as a context manager around the run; ``attach`` must be called when the network exists. ``top`` is the
    outermost process, and ``fmus`` are the files of the FMUs that the environment has. Reports once if the instant is
    the same in two observations, ``patience`` seconds apart (``PATIENCE`` unless given), and the run is not over.
    """

    def __init__(
        self, recorder: Recorder, top: str, fmus: Sequence[str] = (), *, patience: float | None = None
    ) -> None:
        self._recorder = recorder
        self._top = top
        self._fmus = fmus
        self._patience = PATIENCE if patience is None else patience
        self._network: ObservedProgram | None = None
        self._ended = threading.Event()
        self.thread = threading.Thread(target=self._watch, name="standstill", daemon=True)

    def attach(self, network: ObservedProgram) -> None:
        """Attach the running program."""
        self._network = network
        with left_to_the_main_thread():
            self.thread.start()

    def __enter__(self) -> Standstill:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._ended.set()
        if self._network is not None:
            self.thread.join()

    def _watch(self) -> None:
        assert self._network is not None
        before = self._network.now
        while not self._ended.wait(self._patience):
            now = self._network.now
            if now == before:
                # A line of progress may be there.
                clear = "\r\x1b[K" if standard_error().isatty() else ""
                places = self._network.running_processes()[:_MOST_PLACES]
                awaited = self._network.awaited if isinstance(self._network, ProgramInPlace) else ""
                # Asked last: the run may have ended while processes were looked for.
                if not self._network.over:
                    put(f"{clear}{self.line(now, places, awaited)}\n")
                return
            before = now

    def line(self, now: int, places: list[str], awaited: str) -> str:
        """The message at an instant in nanoseconds; ``places`` are those of the running processes, and ``awaited`` is a
        place of the program on another host.
        """
        stands_still = f"cspdiag: simulated time stands still at {now / 1e9:g} s"
        if awaited and not places:
            return f"{stands_still}, waiting for the place `{awaited}`"
        if self._fmus and not places:
            return f"{stands_still}: no process is at work, so perhaps {' or '.join(self._fmus)}: Ctrl-C ends the run"
        prefix = f"{self._top}."
        # A copy in one step, because the scheduler's thread continues meanwhile.
        names = [path.removeprefix(prefix) for path in list(self._recorder.running) if path != self._top]
        more = f" and {len(names) - _MOST_NAMES} more" if len(names) > _MOST_NAMES else ""
        running = f", with {', '.join(names[:_MOST_NAMES])}{more} running" if names else ""
        at_work = f"; at work: {', '.join(places)}" if places else ""
        return (
            f"{stands_still}{running}{at_work}: Ctrl-C ends the run, "
            f"and verify shows which process runs forever without passing a port (assert {self._top} livelock free)"
        )
