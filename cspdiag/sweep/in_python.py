"""Runs of a sweep in Python, where there is no C compiler, or for programs that C cannot express.

Each run is an ordinary one, of code that is generated for its values, in a process of its own kind (``main``): it
shares nothing with native sweeps but the formulas of the measures.
"""

from __future__ import annotations

import os
import pickle
import sys
from collections.abc import Mapping
from typing import IO, TYPE_CHECKING, Any, cast

from cspdiag import pipeline
from cspdiag.base.errors import CspdiagError
from cspdiag.base.parent import end_with
from cspdiag.base.record import record
from cspdiag.base.sources import read_source
from cspdiag.base.span import SourceFile
from cspdiag.settings import SettingError
from cspdiag.simulate.record.leaves import leaf
from cspdiag.simulate.record.recorder import Recorder
from cspdiag.sweep.measures import Measures, Signal, measured
from cspdiag.sweep.result import Result, without_measures

if TYPE_CHECKING:
    from cspdiag.model.types import Real
    from cspdiag.network.ir.network import CoreNetwork, Environment
    from cspdiag.sweep.plan import Plan


@record
class PythonRuns:
    """What all runs of a sweep share; ``texts`` are the files of the program, by path."""

    source: str
    texts: Mapping[str, str]
    environment: str | None
    until: int | None
    real: Real
    measures: Measures


@record
class PythonMaker:
    """Processes that run in Python: what goes to them and comes from them are pickled objects."""

    head: bytes
    measures: int
    runs_once: bool = False

    def command(self) -> tuple[str, ...]:
        """This interpreter, with this module."""
        return (sys.executable, "-m", __name__)

    def read(self, stream: IO[bytes]) -> Result | None:
        """The next result; None if the process has ended before that."""
        try:
            return cast("Result", pickle.load(stream))
        except (EOFError, pickle.UnpicklingError):
            return None


def python_maker(plan: Plan) -> PythonMaker:
    """What makes the runs of all variants: each run has a program of its own."""
    request = plan.request
    runs = PythonRuns(request.source.name, plan.texts, request.environment, request.until, request.real, plan.measures)
    return PythonMaker(pickle.dumps(runs), len(plan.measures.measures))


def task_of(plan: Plan, run: int) -> bytes:
    """The settings of a run."""
    return pickle.dumps(plan.settings(run))


def main() -> None:
    """Make the runs whose settings come from standard input, until its end."""
    # At once, in the middle of a run, too.
    end_with(int(sys.argv[1]), lambda: os._exit(1))
    given: Any = sys.stdin.buffer
    results = sys.stdout.buffer
    # What the program prints is not a result.
    sys.stdout = sys.stderr
    runs = _Runs(pickle.load(given))
    while given.peek(1):
        result = runs.result(pickle.load(given))
        pickle.dump(result, results)
        results.flush()


class _Runs:
    """Makes runs of one program, whose text is read once."""

    def __init__(self, runs: PythonRuns) -> None:
        from cspdiag.sweep.plan import maker_of

        self._runs = runs
        self._level = 0 if any(signal.source == "state" for signal in runs.measures.signals) else 1
        source = SourceFile(name=runs.source, text=runs.texts[runs.source])
        self._maker, _ = maker_of(source, self._read, runs.environment, runs.real)

    def _read(self, path: str) -> SourceFile:
        text = self._runs.texts.get(path)
        return read_source(path) if text is None else SourceFile(name=path, text=text)

    def result(self, settings: Mapping[str, str]) -> Result:
        """The result of a run; that of one that cannot begin, because of a module of the program, has failed."""
        try:
            return self._result(settings)
        except (CspdiagError, OSError) as problem:
            reason = str(problem).partition("\n")[0]
            return without_measures("failed", reason, len(self._runs.measures.measures))

    def _result(self, settings: Mapping[str, str]) -> Result:
        from cspdiag.runtime.kernel.exceptions import described
        from cspdiag.simulate.run.execute import chosen_environment, simulate
        from cspdiag.sweep.plan import first_error

        measures = self._runs.measures
        try:
            network, found = self._maker.network(settings)
        except SettingError as problem:
            return without_measures("refused", str(problem), len(measures.measures))
        if network is None:
            return without_measures("refused", first_error(found), len(measures.measures))
        files = pipeline.generate(network, self._read, level=self._level, traced=False, observed=False)
        recorder = Recorder()
        states = _StateObserver(measures, network, chosen_environment(network, self._runs.environment))
        run = simulate(
            network,
            files,
            environment=self._runs.environment,
            until=self._runs.until,
            recorder=recorder,
            on_environment=states.watch,
        )
        outcome = run.outcome
        observations = sorted([*states.observations, *_of_ports(measures, network, recorder)], key=lambda item: item[0])
        error = "" if outcome.error is None else described(outcome.error)
        return Result(
            cast("Any", outcome.ended), outcome.time / 1e9, error, measured(measures, observations, outcome.time)
        )


def _of_ports(measures: Measures, network: CoreNetwork, recorder: Recorder) -> list[tuple[int, int, float]]:
    """Instants, positions of signals and values of what passed the ports."""
    ports = network.external_ports
    channels = {f"{network.top}.{port.key}": port.type for port in ports}
    histories = recorder.histories(channels)
    found = []
    for position, signal in enumerate(measures.signals):
        if signal.source == "port":
            history = histories.get(f"{network.top}.{ports[signal.number].key}")
            if history is not None:
                values = history.leaf(signal.path, 0, len(history.time))
                found += [
                    (time, position, _number(value, signal)) for time, value in zip(history.time, values, strict=True)
                ]
    return found


def _number(value: Any, signal: Signal) -> float:
    from cspdiag.model.types import TimeType

    return value / 1e9 if isinstance(signal.type, TimeType) else float(value)


class _StateObserver:
    """Notes states of an environment when it has started, and at each instant to which it advances."""

    def __init__(self, measures: Measures, network: CoreNetwork, environment: Environment | None) -> None:
        from cspdiag.codegen.python.plain.laws.signal_names import state_attributes

        self.observations: list[tuple[int, int, float]] = []
        self._signals = [
            (position, signal) for position, signal in enumerate(measures.signals) if signal.source == "state"
        ]
        self._attributes = state_attributes(environment, network) if self._signals and environment is not None else []

    def watch(self, environment: Any) -> None:
        """Be called by an environment."""
        if not self._signals:
            return
        kind = type(environment)
        observe = self._observe

        def start(self: Any) -> None:
            kind.start(self)
            observe(self, 0)

        def advance(self: Any, now: int) -> None:
            kind.advance(self, now)
            observe(self, now)

        # The name stays: faults of the environment have it.
        environment.__class__ = type(kind.__name__, (kind,), {"__slots__": (), "start": start, "advance": advance})

    def _observe(self, environment: Any, now: int) -> None:
        for position, signal in self._signals:
            value = leaf(getattr(environment, self._attributes[signal.number]), signal.path)
            self.observations.append((now, position, _number(value, signal)))


if __name__ == "__main__":
    main()
