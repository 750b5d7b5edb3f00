"""Runs programs on a processor that takes time, and reports whether a sample was missed.

Computing takes no time, the longest stated time, or something in between; everything else is up to the runtime itself.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, NoReturn

from cspdiag import pipeline
from cspdiag.base import SourceFile
from cspdiag.network.ir.network import Network
from cspdiag.runtime import SampledInput, Submodel
from cspdiag.simulate.run.execute import simulate
from cspdiag.simulate.run.probes import parts_of
from tests.analyses.timing.processor import Processor, on_processor, read, wcets
from tests.support.alarm import alarm_after

HORIZON = 150_000_000


STANDS_STILL = "time stands still"


class HungError(Exception):
    """Time stands still."""


class _StandsStillError(BaseException):
    """The same, for which no program has a handler."""


def build(text: str) -> Network | None:
    """The network of a program; None if it has errors."""
    return pipeline.build(SourceFile(name="main.csp", text=text), read).network


def missed(network: Network, seed: int, *, runs: int = 4, until: int = HORIZON, patience: float = 20) -> str:
    """What went wrong in some runs of a program; empty if every sample was taken in time.

    Runs that take more than ``patience`` seconds are taken to stand still.
    """
    stated = wcets(network)
    files = pipeline.generate(network, read)
    source = random.Random(seed)
    ways: list[Callable[[str], int]] = [
        lambda _: 0,
        stated.__getitem__,
        lambda path: source.choice([0, stated[path], source.randint(0, stated[path])]),
        lambda path: source.choice([0, 1, stated[path]]),
    ]
    with _alarm(patience) as rung:
        try:
            for k, times in enumerate(ways[:runs]):
                reported = _run(network, files, times, source.randint(1, 65000) if k >= 2 else None, until)
                if rung:
                    return STANDS_STILL
                if reported:
                    return f"run {k}: {reported}"
        except _StandsStillError:
            return STANDS_STILL
    return ""


@contextmanager
def _alarm(seconds: float) -> Iterator[list[bool]]:
    """Return a list that is no longer empty once the alarm has rung: a run that the alarm ends may look as if it had
    failed.
    """

    def ring() -> NoReturn:
        rung.append(True)
        raise _StandsStillError

    rung: list[bool] = []
    with alarm_after(seconds, ring):
        yield rung


def _run(network: Network, files: Any, times: Callable[[str], int], reseed: int | None, until: int) -> str:
    computed = 0

    def slow(running: Any) -> None:
        def timed(path: str, calculate: Callable[..., Any]) -> Callable[..., Any]:
            def calculated(*inputs: Any) -> Any:
                nonlocal computed
                computed += 1
                if computed > 200_000:
                    raise HungError
                Processor.compute(times(path))
                return calculate(*inputs)

            return calculated

        for part in parts_of(running.process):
            if isinstance(part, Submodel):
                part.calculate = timed(part.name, part.calculate)  # type: ignore[attr-defined]
        begun.extend(port for port in running.ports if isinstance(port, SampledInput))

    begun: list[Any] = []
    with on_processor():
        found = simulate(network, files, until=until, real_time=True, on_start=slow)
    outcome = found.outcome
    if any(outcome.missed.values()):
        return f"missed {outcome.missed}, {outcome.ended} at {outcome.time}: {outcome.error}"
    if outcome.ended == "deadlock" or (outcome.ended == "failed" and isinstance(outcome.error, HungError)):
        return f"{outcome.ended} {outcome.error or ''}"
    return ""
