"""``compile`` and ``run``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from cspdiag.simulate.record.held import columns_of
from cspdiag.simulate.record.run_data import histories
from cspdiag.studio.engine.data import Data
from cspdiag.studio.engine.failure import RequestError
from cspdiag.studio.engine.values import about, shown_values

if TYPE_CHECKING:
    from cspdiag.api import LoadedProgram
    from cspdiag.runtime import Outcome
    from cspdiag.simulate.result import Run

ENDINGS = {
    "terminated": "ended",
    "time limit": "until",
    "deadlock": "deadlock",
    "failed": "fault",
    "stopped": "stopped",
}
DEFAULT_TIME = "10 s"


def compiled(program: LoadedProgram, params: Data) -> Data:
    """The files of a package. Raises ProgramError, and TargetError for what the target cannot express."""
    level = params.get("level", 0)
    return {"files": program.compile(str(params.get("target", "python")), level=level)}


def run(program: LoadedProgram, params: Data) -> Data:
    """A whole run in virtual time. Raises ProgramError, and NoEnvironmentError."""
    until = params.get("until")
    found = program.run(
        params.get("environment"),
        until=DEFAULT_TIME if until is None else until,
        set=settings(params),
        level=params.get("level", 1),
    )
    from cspdiag.simulate.record.files import csv_parts

    signals = signals_of(found)
    return {
        "time": sorted({time for signal in signals.values() for time in signal["t"]}),
        "signals": signals,
        "csv": "".join(csv_parts(found)),
        "summary": found.summary(),
        "ended": ENDINGS[found.outcome.ended],
        "at": found.outcome.time,
        "text": text_of_ending(found.outcome),
    }


def settings(params: Data) -> dict[str, Any]:
    """The values of constants and parameters of a request."""
    given = params.get("set") or {}
    if not isinstance(given, dict):
        raise RequestError("`set` is an object of values by name")
    return given


def signals_of(run: Run) -> dict[str, Data]:
    """The numbers of the external ports over time, in nanoseconds."""
    passed = histories(run)
    found = {}
    for port in run.network.external_ports:
        history = passed.get(f"{run.network.top}.{port.name}")
        for column in columns_of(f"{run.network.top}.{port.name}", port.name, port.type, lambda values, _: values):
            times, values = [], []
            if history is not None:
                times = list(history.time)
                values = shown_values(history.leaf(column.path, 0, len(times)), column.type)
            found[column.name] = {**about(column.type), "direction": port.direction, "t": times, "v": values}
    return found


def text_of_ending(outcome: Outcome) -> str:
    """Why a run ended, for people; outputs that could not be released; how late a run in real time was."""
    from cspdiag.runtime.kernel.durations import shown
    from cspdiag.runtime.kernel.exceptions import described

    lines = [_reason(outcome), *map(described, outcome.release_errors)]
    late = [(period, jitter) for period, jitter in outcome.jitter.items() if jitter.count]
    lines += [f"jitter of the {shown(period)} period: {jitter}" for period, jitter in late]
    return "\n".join(lines)


def _reason(outcome: Outcome) -> str:
    from cspdiag.runtime.kernel.durations import shown
    from cspdiag.runtime.kernel.exceptions import described

    if outcome.deadlock is not None:
        return outcome.deadlock.text
    at = f"at {shown(outcome.time)}"
    if outcome.ended == "failed" and outcome.error is not None:
        return f"ended unsuccessfully {at}: {described(outcome.error)}"
    return {"terminated": "ended by itself", "time limit": "reached the time limit"}.get(
        outcome.ended, "stopped"
    ) + f" {at}"
