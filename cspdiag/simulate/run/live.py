"""A run that is continued piece by piece, while it is watched and its inputs are taken over."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from itertools import islice
from typing import TYPE_CHECKING, Any

from cspdiag.network.ir.network import CoreNetwork, Environment
from cspdiag.runtime.advance.paced import PacedRun
from cspdiag.runtime.advance.resumable import ResumableRun
from cspdiag.runtime.kernel.durations import END_OF_TIME
from cspdiag.runtime.outcome import Outcome
from cspdiag.runtime.outside.drivers import Signal
from cspdiag.runtime.outside.sampled_inputs import SampledInput
from cspdiag.simulate.record.history import History, histories_of
from cspdiag.simulate.record.recorder import Activity, Recorder
from cspdiag.simulate.run.execute import built, chosen_environment, explain
from cspdiag.simulate.run.package import LoadedPackage

if TYPE_CHECKING:
    from cspdiag.runtime.kernel.parameters import Change
    from cspdiag.simulate.record.stored.inputs import RecordedInputs


class LiveRecorder(Recorder):
    """Keeps what happened since it was last emptied, and which processes have ever begun."""

    def __init__(self) -> None:
        super().__init__()
        self.begun: list[tuple[int, str]] = []
        self.ended: list[tuple[int, str]] = []
        self._known: set[str] = set()

    def process_started(self, time: int, path: str, kind: str) -> None:
        """See ``Recorder``. Of a process that runs again and again one activity is kept."""
        self.begun.append((time, path))
        self.running[path] = 0
        if path not in self._known:
            self._known.add(path)
            self.activities.append(Activity(path, kind, time, None))

    def process_ended(self, time: int, path: str) -> None:
        """See ``Recorder``."""
        self.ended.append((time, path))
        self.running.pop(path, None)

    @property
    def count(self) -> int:
        """How many communications there were."""
        return len(self.communication_log) // 5

    def last_communications(self, most: int) -> Iterator[Any]:
        """The last of them, each as the fields of ``Communication``."""
        return islice(self.communications, max(0, self.count - most), None)

    def port_histories(self, ports: Collection[str]) -> Mapping[str, History]:
        """What passed the external ports, with safe values."""
        passed = (entry for entry in self.communications if entry[1] in ports)
        released = ((time, port, value, "", "") for time, port, value in self.releases if port in ports)
        return histories_of((*passed, *released), self.samples)

    def taken(self) -> LiveRecorder:
        """What happened until now, which this one forgets."""
        found = LiveRecorder()
        self.hand_to(found)
        return found

    def hand_to(self, found: LiveRecorder) -> None:
        """Let another one have what happened until now."""
        found.running = dict(self.running)
        for name in ("communication_log", "sample_log", "releases", "changes", "refused", "begun", "ended"):
            happened: list[Any] = getattr(self, name)
            setattr(found, name, happened.copy())
            happened.clear()  # The run keeps adding to the same lists.


class LiveRun:
    """A program in an environment, from time 0 on, until ``until`` (nanoseconds).

    In virtual time the trace is that of ``execute.simulate`` as long as nobody takes over an input. In ``real_time``
    the clock runs from now on; its caller continues it often enough. ``inputs`` are those that the program is given,
    instead of what the environment computes. Raises what ``simulate`` raises before a run.
    """

    def __init__(
        self,
        network: CoreNetwork,
        files: Mapping[str, str],
        environment: str | None = None,
        until: int | None = None,
        *,
        real_time: bool = False,
        inputs: RecordedInputs | None = None,
    ) -> None:
        self.network = network
        self.environment: Environment | None = chosen_environment(network, environment)
        self.recorder = LiveRecorder()
        self._until = END_OF_TIME if until is None else min(until, END_OF_TIME)
        self._package = LoadedPackage(network.name, files)
        self._hands: dict[Any, Any] = {}
        self._reached_instant = 0
        self._is_open = True
        self._is_explained = False
        try:
            running, plant = built(network, self.environment, self._package)
            drivers = {} if plant is None else plant.drivers
            taken = [port for port in network.external_ports if port.direction == "in"]
            self._signals = {port.name: drivers[port.key] for port in taken if type(drivers.get(port.key)) is Signal}
            self._sampled = [port for port in running.ports if isinstance(port, SampledInput)]
            self.parameters = running.parameters
            if plant is not None and inputs is not None:
                from cspdiag.simulate.record.stored.inputs import replace_environment

                replace_environment(plant, inputs)
                self.parameters.plan(inputs.parameter_changes)
            if plant is not None:
                _let_hands_in(plant, self._hands)
            on_miss = self.environment.on_miss if self.environment is not None else "timeout"
            observer: Any = self.recorder
            self._paced: PacedRun | None = None
            if real_time:
                self._paced = PacedRun(running, plant, until=self._until, on_miss=on_miss, observer=observer)
            self._run = self._paced or ResumableRun(running, plant, on_miss=on_miss, observer=observer)
        except BaseException:
            self._package.close()
            raise
        self._look()

    @property
    def inputs(self) -> frozenset[str]:
        """The inputs of the program that a hand may take over from the environment."""
        return frozenset(self._signals)

    @property
    def now(self) -> int:
        """The present instant in nanoseconds."""
        return max(self._run.now, self._reached_instant) if self.outcome is None else self.outcome.time

    @property
    def missed(self) -> dict[str, int]:
        """How many samples were missed until now, by the inputs of which some were."""
        top = f"{self.network.top}."
        return {port.name.removeprefix(top): port.missed for port in self._sampled if port.missed}

    @property
    def next_instant(self) -> int | None:
        """The next instant at which something may happen."""
        return self._run.next_instant

    @property
    def outcome(self) -> Outcome | None:
        """How it has ended, if it has."""
        return self._run.outcome

    @property
    def lateness(self) -> str:
        """How late a run in real time was, for people, if its outcome does not say it."""
        return ""

    def take(self, name: str, value: Any) -> None:
        """Take over an input from the next instant on; a value of its type."""
        self._hands[self._signals[name]] = value

    def give_back(self, name: str) -> None:
        """Let the environment have an input again, from the next instant on."""
        self._hands.pop(self._signals[name], None)

    def plan(self, change: Change) -> None:
        """Change a parameter of the program at the next instant after the time of the change."""
        self.parameters.plan([change])

    def advance(self, until: int, wants_pause: Callable[[], bool]) -> bool:
        """Continue up to an instant; False if ``wants_pause`` ended that before."""
        reached = self._run.advance(min(until, self._until), wants_pause)
        return self._reached(reached, until)

    def keep_pace(self, duration: int) -> None:
        """Continue a run in real time for that many nanoseconds of its clock."""
        assert self._paced is not None
        until = min(self._paced.present + duration, self._until)
        self._run.advance(until)
        instant = self.next_instant
        is_late = instant is not None and until < self._until
        self._reached(True, min(until, instant - 1) if instant is not None and is_late else until)

    def step(self, wants_pause: Callable[[], bool]) -> bool:
        """Continue until, after a step of a process, a pause is wanted; False if one was."""
        return self._reached(self._run.step(self._until, wants_pause), self._until)

    def communicate(self, count: int, wants_pause: Callable[[], bool]) -> bool:
        """Continue until, after a step of a process, that many more values were communicated, or a pause is wanted:
        then False.
        """
        goal = self.recorder.count + count
        return self.step(lambda: self.recorder.count >= goal or wants_pause())

    def _reached(self, reached: bool, until: int) -> bool:
        if reached and until >= self._until:
            self._run.end_at(self._until)
        elif reached:
            self._reached_instant = max(until, self._reached_instant)
        self._look()
        return reached

    def _look(self) -> None:
        """Note the refused changes, and explain a deadlock."""
        refused = self.parameters.refused
        for change, why in refused:
            self.recorder.refused.append((change.time, change.parameter, why))
        refused.clear()
        if self.outcome is not None and not self._is_explained:
            self._is_explained = True
            explain(self.outcome, self.network, self.recorder)

    def waiting(self, most: int) -> list[tuple[str, str, tuple[str, ...], str | None]]:
        """The processes that wait, as ``ResumableRun.waiting`` finds them."""
        return self._run.waiting(most)

    def end(self) -> Outcome:
        """End it where it is, and release the outputs, unless it has ended already."""
        outcome = self._run.end(self.now)
        if self._is_open:
            self._is_open = False
            self._look()
            self._package.close()
        return outcome


def _let_hands_in(plant: Any, hands: dict[Any, Any]) -> None:
    """Let values of hands take the place of what an environment of generated Python gives."""
    kind = type(plant)

    def start(self: Any) -> None:
        kind.start(self)
        for signal, value in hands.items():
            signal.value = value

    def advance(self: Any, now: int) -> None:
        kind.advance(self, now)
        for signal, value in hands.items():
            signal.value = value

    plant.__class__ = type(kind.__name__, (kind,), {"__slots__": (), "start": start, "advance": advance})
