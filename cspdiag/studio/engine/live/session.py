"""A live session: a program that runs one piece after the other, in virtual time as fast as the page wants, or in real
time with its devices.
"""

from __future__ import annotations

import time
from functools import partial
from typing import TYPE_CHECKING, Any

from cspdiag import pipeline
from cspdiag.api import ProgramError
from cspdiag.arguments import settings_of, time_limit
from cspdiag.base.errors import file_errors
from cspdiag.runtime.deadlock.reports import missing_partner
from cspdiag.runtime.kernel.durations import END_OF_TIME
from cspdiag.simulate.record.leaves import leaves
from cspdiag.simulate.run.live import LiveRun
from cspdiag.studio.engine.checking import parameters_of
from cspdiag.studio.engine.data import Data, Notify
from cspdiag.studio.engine.failure import RequestError
from cspdiag.studio.engine.live.devices import refuse_devices
from cspdiag.studio.engine.live.frames import Frames, waiting
from cspdiag.studio.engine.running import ENDINGS, settings, text_of_ending
from cspdiag.studio.engine.values import about, number_of
from cspdiag.tuning import parse_change

if TYPE_CHECKING:
    from cspdiag.network.ir.network import CoreNetwork, ExternalPort
    from cspdiag.runtime import Outcome
    from cspdiag.simulate.record.stored.inputs import RecordedInputs
    from cspdiag.simulate.steered.run import SteeredRun
    from cspdiag.studio.engine.programs import Files

INTERVAL = 1 / 60
"""Seconds between two frames."""
_WORK = 0.8 * INTERVAL
"""Seconds of computing for a frame; the rest is for requests."""
_VIRTUAL = "run it in virtual time"
_PATIENCE = 1.0
"""Seconds that a step takes at most, for programs that never leave an instant."""


class Session:
    """One run. ``notify`` takes what it sends. Raises what building and starting raise."""

    def __init__(self, number: int, files: Files, params: Data, notify: Notify) -> None:
        self.number = number
        self._notify = notify
        environment, until = _text(params, "environment"), params.get("until")
        self._real_time = params.get("real_time", False)
        if not isinstance(self._real_time, bool):
            raise RequestError("`real_time` is true or false")
        self._target = params.get("target", "python")
        if self._target not in ("python", "c"):
            raise RequestError("`target` is python or c")
        built = pipeline.build(
            files.source,
            files.read,
            environment=environment,
            settings=settings_of(settings(params)),
            alone=True,
        )
        if built.network is None or built.checked.program is None:
            raise ProgramError(built.checked.report.diagnostics)
        self._program = built.checked.program
        limit = None if until is None else time_limit(until)
        network, inputs = self._given(built.network, environment, _text(params, "inputs"))
        self._network = network
        if inputs is not None:
            limit = inputs.end if limit is None else min(limit, inputs.end)
        self._run = self._started(files, environment, limit, inputs)
        self._until = limit
        self._frames = Frames(self._run)
        self._ports = {port.name: port for port in network.external_ports}
        self._speed: float | None = 1.0 if self._real_time else None
        self._base = (0.0, 0)
        """An instant of the clock in seconds, and the instant of the run that belongs to it."""
        self._due = 0.0
        self._has_ended = False

    def _started(
        self, files: Files, environment: str | None, until: int | None, inputs: RecordedInputs | None
    ) -> LiveRun | SteeredRun:
        refuse_devices(self._network, environment, self._target)
        with file_errors():
            if self._target == "c":
                from cspdiag.studio.engine.live.native import native_run

                return native_run(
                    self._network, files.read, environment, until, real_time=self._real_time, inputs=inputs
                )
            package = pipeline.generate(self._network, files.read, level=1, traced=True, observed=True)
        return LiveRun(self._network, package, environment, until, real_time=self._real_time, inputs=inputs)

    def _given(
        self, network: CoreNetwork, environment: str | None, recording: str | None
    ) -> tuple[CoreNetwork, RecordedInputs | None]:
        """The inputs of a recording, if they are wanted, and the network with an environment that they take part in."""
        if recording is None:
            return network, None
        if self._real_time:
            raise RequestError("a recording has its own time", _VIRTUAL)
        from cspdiag.simulate.record.stored.given import inputs_of
        from cspdiag.simulate.record.stored.inputs import with_environment

        network = with_environment(network)
        return network, inputs_of(network, environment, recording)

    def description(self) -> Data:
        """What the page needs to know of the run."""
        environment = self._run.environment
        return {
            "session": self.number,
            "top": self._network.top,
            "environment": None if environment is None else environment.name,
            "real_time": self._real_time,
            "target": self._target,
            "signals": [
                {"name": name, "direction": port.direction, **about(kind), "hand": path == () and self._is_free(port),
                 "period": None if port.sampling is None else port.sampling.period}
                for port in self._network.external_ports
                for name, kind, path in leaves(port.name, port.type)
            ],
            "processes": [{"path": item.path, "name": item.class_name} for item in self._network.instances],
            "channels": [net.path for net in self._network.nets],
            "groups": [
                {"name": group.name, "modes": group.modes, "ports": list(group.ports)} for group in self._frames.groups
            ],
            "parameters": list(parameters_of(self._program)),
            "until": self._until,
        }  # fmt: skip

    def _is_free(self, port: ExternalPort) -> bool:
        return port.name in self._run.inputs

    # Requests

    def play(self, params: Data) -> Data:
        """Run at a speed relative to real time; 0 is as fast as possible."""
        speed = params.get("speed", 1)
        if isinstance(speed, bool) or not isinstance(speed, int | float) or not 0 <= speed <= 1e6:
            raise RequestError("`speed` is a number from 0 to 1000000")
        self._require_running()
        if self._real_time:
            if speed != 1:
                raise RequestError("a program that runs in real time has the speed 1", _VIRTUAL)
            return {}
        self._speed = float(speed)
        self._set_base()
        self._due = time.perf_counter()
        return {}

    def pause(self) -> Data:
        """Stop where it is."""
        self._require_virtual()
        self._speed = None
        return {"now": self._run.now}

    def step(self, params: Data) -> Data:
        """Continue by some communications, or instants at which something happens."""
        by, count = params.get("by", "communication"), params.get("count", 1)
        if by not in ("communication", "instant"):
            raise RequestError("`by` is communication or instant")
        if isinstance(count, bool) or not isinstance(count, int) or not 1 <= count <= 100_000:
            raise RequestError("`count` is a whole number from 1 to 100000")
        self._require_virtual()
        self._require_running()
        self._speed = None
        over = time.perf_counter() + _PATIENCE
        if by == "communication":
            self._run.communicate(count, lambda: time.perf_counter() > over)
        else:
            for _ in range(count):
                if not self._step_instant(over):
                    break
        self._show()
        return {"now": self._run.now}

    def _step_instant(self, over: float) -> bool:
        run = self._run
        if not run.advance(run.now, lambda: time.perf_counter() > over) or run.outcome is not None:
            return False
        instant = run.next_instant
        return run.advance(END_OF_TIME if instant is None else instant, lambda: time.perf_counter() > over)

    def input(self, params: Data) -> Data:
        """Take over an input of the program, or give it back to the environment."""
        name, value = params.get("name"), params.get("value")
        port = self._ports.get(name) if isinstance(name, str) else None
        if port is None or port.direction != "in":
            raise RequestError(f"the program has no input {name!r}")
        if not self._is_free(port):
            raise RequestError(f"the input `{name}` is that of a device, which nobody can take over")
        if value is None:
            self._run.give_back(port.name)
        else:
            self._run.take(port.name, number_of(port.name, port.type, value))
        return {}

    def tune(self, params: Data) -> Data:
        """Change a parameter of the program. Raises SettingError."""
        name, value = params.get("name"), params.get("value")
        if not isinstance(name, str) or isinstance(value, dict | list) or value is None:
            raise RequestError("`name` is that of a parameter or of a part of one, `value` a number or a text")
        self._require_running()
        (text,) = settings_of({name: value}).values()
        self._run.plan(parse_change(self._program, self._run.now, name, text))
        return {}

    def state(self) -> Data:
        """Where the run is, whether it plays, and which process waits for what."""
        return {
            "now": self._run.now,
            "playing": self._speed is not None,
            "running": list(self._run.recorder.running),
            "waiting": waiting(self._run),
        }

    def stop(self) -> Data:
        """End the run, and release the outputs."""
        self._speed = None
        self._run.end()
        self._show()
        return {"now": self._run.now}

    # Time

    @property
    def keeps_pace(self) -> bool:
        """Whether it runs, in real time."""
        return self._real_time and self._speed is not None

    def due(self) -> float | None:
        """Seconds until ``proceed`` is to be called; None: the run does not play."""
        if self._speed is None:
            return None
        return 0.0 if self._real_time else max(0.0, self._due - time.perf_counter())

    def proceed(self) -> None:
        """Continue for a frame, if one is due."""
        if self._real_time:
            self._keep_pace()
            return
        began = time.perf_counter()
        if self._speed is None or began < self._due:
            return
        self._due = began + INTERVAL
        over = began + _WORK
        clock, instant = self._base
        until = END_OF_TIME if not self._speed else instant + round((began - clock) * self._speed * 1e9)
        if not self._run.advance(min(until, END_OF_TIME), lambda: time.perf_counter() > over):
            self._set_base()  # It is slower than wanted, and does not try to catch up.
        self._show()

    def _keep_pace(self) -> None:
        if self._speed is not None:
            self._run.keep_pace(round(INTERVAL * 1e9))
            self._show()

    def _set_base(self) -> None:
        self._base = time.perf_counter(), self._run.now

    def _require_running(self) -> None:
        if self._has_ended:
            raise RequestError("the run has ended", "start it again")

    def _require_virtual(self) -> None:
        if self._real_time:
            raise RequestError("a program that runs in real time can be stopped, not paused", _VIRTUAL)

    def _show(self) -> None:
        if self._has_ended:
            return
        outcome = self._run.outcome
        if outcome is not None:
            self._has_ended = True
            self._speed = None
        # Asking each process takes longer than some periods.
        frame = self._frames.next(with_waiting=not self._real_time)
        self._notify("frame", lambda: {"session": self.number, **frame()})
        if outcome is not None:
            self._run.end()
            self._notify("ended", partial(self._ended, outcome))

    def _ended(self, outcome: Outcome) -> Data:
        deadlock = outcome.deadlock
        stuck = () if deadlock is None else deadlock.waiting
        return {
            "session": self.number,
            "at": outcome.time,
            "reason": ENDINGS[outcome.ended],
            "text": "\n".join(filter(None, (text_of_ending(outcome), self._run.lateness))),
            "missed": self._run.missed,
            "waiting": [
                {"process": each.path, "channels": list(each.channels), "for": each.waits, "place": each.place,
                 "partners": list(each.partners), "why": missing_partner(each)}
                for each in stuck
            ],
            "ring": [] if deadlock is None else [each.path for each in deadlock.cycle],
        }  # fmt: skip


def _text(params: Data, name: str) -> Any:
    value = params.get(name)
    if value is not None and not isinstance(value, str):
        raise RequestError(f"`{name}` is a text")
    return value
