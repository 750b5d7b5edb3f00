"""Steps the generated program through a trace, to see whether it does what the transition system does.

Values that the trace leaves open are tried one after the other, and then numbers of rounds of loops. The program must
then be able to do what was found on its real runtime, with its priorities and exact times (``guided``).
"""

from __future__ import annotations

from collections.abc import Mapping

from cspdiag.base.record import replaced
from cspdiag.network.ir.network import CoreNetwork
from cspdiag.proofs.verdict import Limits
from cspdiag.simulate.run.package import LoadedPackage
from cspdiag.verify.decisions import Decisions
from cspdiag.verify.guided.guided import Guided
from cspdiag.verify.replay.attempt import Attempt
from cspdiag.verify.replay.result import Judge, Replay
from cspdiag.verify.replay.rounds import Rounds
from cspdiag.verify.runs.agreement import difference
from cspdiag.verify.runs.faulting import numbers_at_faults
from cspdiag.verify.runs.trace import Trace
from cspdiag.verify.runs.values import Values, numbers_of, types_of

MOST_ATTEMPTS = 400


def replay(
    network: CoreNetwork,
    files: Mapping[str, str],
    trace: Trace,
    judge: Judge | None = None,
    limits: Limits | None = None,
    *,
    exactly: bool = False,
) -> Replay:
    """Steps the package ``files`` of ``network``, compiled without optimization, through a trace, after which the
    ``judge`` has to find something wrong.

    ``exactly``: only with the values of the trace; otherwise the program may pass other values. Raises BodyError for a
    hand-written body that cannot be made, and LimitError when the time of the ``limits`` is up.
    """
    limits = limits or Limits()
    package = LoadedPackage(network.name, files)
    guided = Guided(network, package, limits)
    attempts = _Attempts(network, package, trace, judge, guided, limits, exactly=exactly)
    try:
        result = attempts.best()
        if not (result.succeeded or result.other or trace.exact):
            result = max(attempts.best(Rounds(network, trace)), result, key=_distance)
        if not (result.succeeded or result.other) and trace.failure in {"deadlock", "no termination"}:
            run = guided.at_random(replaced(trace, failure="deadlock", cycle=()))
            return result if run is None else replaced(result, other=run.happened, standing=run.standing)
        return result
    finally:
        package.close()


def _distance(result: Replay) -> tuple[bool, bool, int]:
    """How far the program has come."""
    return result.succeeded, result.excluded, result.steps


class _Attempts:
    """Attempts to follow one trace."""

    def __init__(
        self,
        network: CoreNetwork,
        package: LoadedPackage,
        trace: Trace,
        judge: Judge | None,
        guided: Guided,
        limits: Limits,
        *,
        exactly: bool,
    ) -> None:
        self._network = network
        self._package = package
        self._trace = trace
        self._judge = judge
        self._guided = guided
        self._limits = limits
        self._types = types_of(network) if exactly else {}
        types = package.module("types") if network.enums or network.structs else None
        at_faults = () if exactly or trace.exact else numbers_at_faults(network)
        self._values = Values(types, numbers_of(network), at_faults)

    def best(self, rounds: Rounds | None = None) -> Replay:
        """The attempt that succeeds, or gets furthest."""
        decisions = Decisions()
        best: Replay | None = None
        for _ in range(MOST_ATTEMPTS):
            result = self._made(decisions, rounds)
            if result.succeeded:
                return result
            if best is None or _distance(result) > _distance(best):
                best = result
            exhausted = self._guided.exhausted or (rounds is not None and rounds.exhausted)
            if best.other or exhausted or not decisions.advance():
                break
        assert best is not None
        return best

    def _made(self, decisions: Decisions, rounds: Rounds | None) -> Replay:
        self._limits.check()
        attempt = Attempt(
            self._network,
            self._package,
            self._trace,
            self._judge,
            self._values,
            decisions,
            rounds,
            self._limits,
        )
        result = attempt.run()
        if not result.succeeded:
            return result
        further = self._trace.rounds or bool(result.added)
        run = self._guided.follow(
            attempt.conductor.passed, self._trace, attempt.cycle, ends=attempt.ends, further=further
        )
        led = attempt.led(run, result)
        unlike = difference(self._trace, led.communications, self._types) if led.succeeded else None
        return led if unlike is None else replaced(led, steps=unlike[0], divergence=unlike[1], other=())
