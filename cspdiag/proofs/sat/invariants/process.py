"""The solver for weights, in an operating-system process that can be ended at any time: ``python -m
cspdiag.proofs.sat.invariants.process SECONDS``.

The process reads lines of JSON, first the problem and then candidates, and answers each candidate with a line. It uses
no more memory than it is given: if it needs more it ends without an answer. It ends itself after those seconds,
because a thread to end it could not be started safely where the alarm of the time limit may ring.
"""

from __future__ import annotations

import faulthandler
import json
import subprocess
import sys
from collections.abc import Sequence
from importlib import import_module
from typing import Any

from cspdiag.proofs.sat.invariants.problem import Problem
from cspdiag.proofs.verdict import Limits

LONGEST = 1e9
"""Seconds: about the longest time limit that operating systems know."""

MARGIN = 1e-9
"""Weights nearer to 0 than this are 0."""


class WeightsProcess:
    """The client of the process: a context that starts it when it is first needed, and ends it, at the latest when the
    time is up.
    """

    def __init__(self, problem: Problem, limits: Limits) -> None:
        self._problem = problem
        self._limits = limits
        self._process: subprocess.Popen[str] | None = None

    def __enter__(self) -> WeightsProcess:
        return self

    def __exit__(self, *_: object) -> None:
        if self._process is not None:
            self._process.kill()
            self._process.communicate()

    def weights(self, candidate: Sequence[int]) -> list[float] | None:
        """Weights of the places that exclude a candidate, up to rounding; None if the solver finds none, or the time is
        up.
        """
        places = [of[state] for of, state in zip(self._problem.places, candidate, strict=True)]
        try:
            process = self._started()
            assert process.stdin is not None
            assert process.stdout is not None
            process.stdin.write(json.dumps(places) + "\n")
            process.stdin.flush()
            answer = process.stdout.readline()
        except (OSError, ValueError):
            return None
        found: list[float] | None = json.loads(answer) if answer else None
        return found

    def _started(self) -> subprocess.Popen[str]:
        if self._process is None:
            self._process = subprocess.Popen(
                [sys.executable, "-m", __name__, str(self._limits.remaining)],
                stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
            )  # fmt: skip
            assert self._process.stdin is not None
            problem = self._problem
            start = [places[state] for places, state in zip(problem.places, problem.initial, strict=True)]
            described = {"start": start, "free": problem.free, "events": problem.events, "memory": self._limits.memory}
            self._process.stdin.write(
                json.dumps({**described, "places": sum(len(places) for places in problem.places)}) + "\n"
            )
        return self._process


class _Program:
    """The linear program: minimizes the sum of the absolute weights with which a candidate exceeds the initial state by
    1.

    Its variables are the positive and negative parts of the weights, and, for every party of an event, the most that it
    may add.
    """

    def __init__(self, problem: dict[str, Any]) -> None:
        self._optimize, sparse = import_module("scipy.optimize"), import_module("scipy.sparse")
        self._places: int = problem["places"]
        self._variables = 2 * self._places
        entries: list[tuple[int, int, float]] = []
        row = 0
        for before, after in problem["free"]:
            entries += self._difference(row, before, after)
            row += 1
        for event in problem["events"]:
            most = range(self._variables, self._variables + len(event))
            self._variables += len(event)
            for changes, bound in zip(event, most, strict=True):
                for before, after in changes:
                    entries += [*self._difference(row, before, after), (row, bound, -1.0)]
                    row += 1
            entries += [(row, bound, 1.0) for bound in most]
            row += 1
        rows, columns, values = zip(*entries, strict=True)
        self._matrix = sparse.csr_array((values, (rows, columns)), shape=(row, self._variables))
        self._start = set(problem["start"])

    def _difference(self, row: int, before: int, after: int) -> list[tuple[int, int, float]]:
        if before == after:
            return []
        return [
            (row, after, 1.0), (row, self._places + after, -1.0),
            (row, before, -1.0), (row, self._places + before, 1.0),
        ]  # fmt: skip

    def solve(self, candidate: Sequence[int]) -> list[float] | None:
        weights = [0.0] * self._variables
        for place in candidate:
            weights[place], weights[self._places + place] = 1.0, -1.0
        costs = [1.0] * (2 * self._places) + [0.0] * (self._variables - 2 * self._places)
        bounds: list[tuple[float | None, float | None]] = [(0.0, None)] * (2 * self._places)
        bounds += [(None, None)] * (self._variables - 2 * self._places)
        for place in self._start:
            bounds[place] = bounds[self._places + place] = (0.0, 0.0)
        # Rows are at most 0; the candidate is at least 1.
        found = self._optimize.linprog(
            costs, A_ub=self._matrix, b_ub=[0.0] * self._matrix.shape[0],
            A_eq=[weights], b_eq=[1.0], bounds=bounds, method="highs",
        )  # fmt: skip
        if found.status != 0:
            return None
        values = [float(found.x[place] - found.x[self._places + place]) for place in range(self._places)]
        return [0.0 if abs(value) < MARGIN else value for value in values]


def limit_memory(more: int) -> None:
    """Limits this process to ``more`` bytes in addition to those that it uses now; only on Linux, where that number is
    known.
    """
    try:
        resource = import_module("resource")
        with open("/proc/self/statm", encoding="ascii") as file:
            taken = int(file.read().split()[0]) * resource.getpagesize()
        hard = resource.getrlimit(resource.RLIMIT_AS)[1]
        most = taken + more if hard == resource.RLIM_INFINITY else min(taken + more, hard)
        resource.setrlimit(resource.RLIMIT_AS, (most, hard))
    except (ImportError, OSError):
        pass


def main() -> None:
    """Answers candidates until the input ends, or the time is up."""
    # This ends the process also where the solver keeps the interpreter busy, and needs no signals.
    faulthandler.dump_traceback_later(min(max(float(sys.argv[1]), 0.001), LONGEST), exit=True)
    # Loaded before the limit is set, so the libraries do not count.
    import_module("scipy.optimize")
    problem = json.loads(sys.stdin.readline())
    limit_memory(problem["memory"])
    program = _Program(problem)
    for line in sys.stdin:
        print(json.dumps(program.solve(json.loads(line))), flush=True)


if __name__ == "__main__":
    main()
