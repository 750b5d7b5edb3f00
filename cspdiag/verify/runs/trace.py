"""Traces to replay, as ``cspdiag verify --trace-out`` writes them."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

from cspdiag.base.errors import CspdiagError
from cspdiag.base.files.json_text import read_json
from cspdiag.base.record import record
from cspdiag.model.types import REALS, Real
from cspdiag.proofs.counterexamples.counterexample import is_shown

FORMAT = "cspdiag trace 1"
_ROUNDS = "rounds"


class TraceError(CspdiagError, ValueError):
    """The file is not a trace to replay; the message is one line."""


class DivergenceError(CspdiagError):
    """The program does not follow the trace; the message says where."""


@record
class TraceStep:
    """What has to happen next; ``parties`` are the processes that take part: their names, and the paths of the
    instances that they belong to.
    """

    kind: str
    channel: str
    value: str | None
    parties: tuple[tuple[str, str], ...]

    def __str__(self) -> str:
        return " ".join(filter(None, (self.channel or self.kind, self.value)))

    @property
    def shown(self) -> bool:
        """Whether it is in the table of the counterexample."""
        return is_shown(self.kind, len(self.parties))


@record
class Trace:
    """A counterexample of ``process``, compiled with ``settings`` in the precision ``real``.

    ``stuck`` are the processes that never continue after it, each with the channels at which it waits. ``exact``: the
    proof left nothing open, so what was done once can be repeated.
    """

    process: str
    settings: Mapping[str, str]
    assertion: str
    failure: str
    steps: tuple[TraceStep, ...]
    cycle: tuple[TraceStep, ...]
    stuck: tuple[tuple[str, frozenset[str]], ...]
    exact: bool
    hidden: frozenset[str] = frozenset()
    """Channels of the environment that a specification does not see."""
    stuck_names: tuple[str, ...] = ()
    """The names of the processes in ``stuck``, in the same order."""
    rounds: bool = False
    """Whether it has rounds of loops whose end the proof left open."""
    real: Real = "double"

    def shown_before(self, number: int) -> int:
        """How many of its first ``number`` steps, including those of its cycle, are in the table."""
        return sum(step.shown for step in (*self.steps, *self.cycle)[:number])

    @property
    def round(self) -> str:
        """What is repeated forever without a communication: the delays, or the processes that do something that no
        diagram shows.
        """
        delays = [
            f"`{step.channel.rpartition(': ')[2]}` of {self._names(step)}" for step in self.cycle if step.kind == "time"
        ]
        if delays:
            return f"without a communication: {', '.join(delays)}"
        return f"without a communication or a delay: {', '.join(dict.fromkeys(map(self._names, self.cycle)))}"

    def _names(self, step: TraceStep) -> str:
        return ", ".join(f"`{name.removeprefix(f'{self.process}.')}`" for name, _ in step.parties)

    def hides(self, channel: str) -> bool:
        """Whether a specification does not see a channel of the environment, or the array of ports that it is an
        element of.
        """
        return channel in self.hidden or channel.rpartition("[")[0] in self.hidden


def trace_text(
    counterexample: Mapping[str, Any],
    process: str,
    assertion: str,
    settings: Mapping[str, str],
    left_open: Sequence[str],
    hidden: Sequence[str] = (),
    real: Real = "double",
) -> str:
    """The file of a counterexample (see ``analyses.counterexamples.encode``).

    ``left_open`` is what the proof leaves open, ``hidden`` the ports that a specification does not see.
    """
    whole = {
        "format": FORMAT,
        "process": process,
        "assertion": assertion,
        "settings": dict(settings),
        "real": real,
        "left_open": list(left_open),
        "hidden": list(hidden),
        **counterexample,
    }
    return json.dumps(whole, indent=2) + "\n"


def read_trace(text: str) -> Trace:
    """The trace in the text of a file. Raises TraceError."""
    try:
        whole = read_json(text)
    except ValueError as problem:
        raise TraceError(f"not JSON: {problem}") from None
    if not isinstance(whole, dict) or whole.get("format") != FORMAT:
        raise TraceError("not a trace written by `cspdiag verify --trace-out`")
    try:
        return Trace(
            process=_text(whole["process"]),
            settings={_text(name): _text(value) for name, value in whole["settings"].items()},
            real=_real(whole.get("real", "double")),
            assertion=_text(whole["assertion"]),
            failure=_failure(_text(whole["failure"]), repeats=bool(whole["cycle"])),
            steps=tuple(step for entry in whole["steps"] for step in _steps(entry, whole["process"])),
            cycle=tuple(_step(step, whole["process"]) for step in whole["cycle"]),
            exact=not whole["left_open"],
            rounds=any(entry["kind"] == _ROUNDS for entry in whole["steps"]),
            hidden=frozenset(f"{whole['process']}.{_text(port)}" for port in whole.get("hidden", ())),
            stuck=tuple((_text(entry["path"]), frozenset(map(_text, entry["channels"]))) for entry in whole["waiting"]),
            stuck_names=tuple(_whole(entry["process"], whole["process"]) for entry in whole["waiting"]),
        )
    except (KeyError, TypeError, AttributeError) as problem:
        raise TraceError(f"an incomplete trace ({type(problem).__name__}: {problem})") from None


def _steps(entry: Mapping[str, Any], process: str) -> list[TraceStep]:
    """A step, or those of all rounds of a loop."""
    if entry["kind"] != _ROUNDS:
        return [_step(entry, process)]
    return [_step(step, process) for step in entry["steps"]] * int(entry["times"])


def _failure(failure: str, *, repeats: bool) -> str:
    """The failure that the program must show: one that does not terminate, and repeats nothing, gets stuck."""
    return "deadlock" if failure == "no termination" and not repeats else failure


def _step(entry: Mapping[str, Any], process: str) -> TraceStep:
    value = entry["value"]
    return TraceStep(
        kind=_text(entry["kind"]),
        channel=_text(entry["channel"]),
        value=None if value is None else _text(value),
        parties=tuple((_whole(party["process"], process), _text(party["path"])) for party in entry["parties"]),
    )


def _real(value: object) -> Real:
    for real in REALS:
        if value == real:
            return real
    raise TypeError(f"`real` is {' or '.join(REALS)}, not {value!r}")


def _text(value: object) -> str:
    if not isinstance(value, str):
        raise TypeError(f"a text is needed, not {value!r}")
    return value


def _whole(name: object, process: str) -> str:
    """The hierarchical name of a process whose name is given below the outermost one."""
    return process if name == process else f"{process}.{_text(name)}"
