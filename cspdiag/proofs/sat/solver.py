"""One interface to the SAT solvers that may be installed: python-sat, or else z3."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from importlib import import_module
from typing import Any, Protocol, TypeAlias

_IN_BROWSER = sys.platform == "emscripten"
MISSING = (
    "there is no SAT solver in the browser"
    if _IN_BROWSER
    else "no SAT solver is installed (pip install 'cspdiag[verify]')"
)

Clause: TypeAlias = list[int]
"""A disjunction of literals: the positive number of a variable, or its negation."""


_FIRST_PROPAGATIONS = 100_000
"""After which a solver looks at the clock for the first time: some hundredths of a second."""


class Solver(Protocol):
    """A set of clauses that only grows, and models of it."""

    def add(self, clauses: list[Clause]) -> None:
        """Add clauses."""

    def solve(self, assumed: Clause) -> set[int] | None:
        """Return the variables that are true in a model of all clauses and the assumed literals, or None if there is no
        model.

        Raises ``SolverTimeoutError`` when the time is up.
        """

    def close(self) -> None:
        """Release the memory; the solver cannot be used afterwards."""


class SolverTimeoutError(Exception):
    """The solver did not decide in its time."""


def find_solver() -> Callable[[float], Solver] | None:
    """The solver to use, python-sat or else z3, to be called with the seconds that it may take in total; None if
    neither is installed.
    """
    for solver in _SOLVERS:
        try:
            solver.load()
        except ImportError:
            continue
        return solver
    return None


class _PySat:
    """MiniSat 2.2 of python-sat: incremental, and limited by a number of propagations.

    It starts no thread to interrupt it: the alarm of the time limit may ring at any instruction, and where it cut off
    the start of a thread, that thread would be left behind, or awaited forever.
    """

    @staticmethod
    def load() -> Any:
        return import_module("pysat.solvers")

    def __init__(self, seconds: float) -> None:
        self._solver = self.load().Minisat22()
        self._end = time.monotonic() + seconds

    def add(self, clauses: list[Clause]) -> None:
        self._solver.append_formula(clauses, no_return=True)

    def solve(self, assumed: Clause) -> set[int] | None:
        answer = self._answer(assumed)
        if not answer:
            return None
        return {literal for literal in self._solver.get_model() if literal > 0}

    def _answer(self, assumed: Clause) -> bool:
        """Search in ever longer parts, each of which keeps the clauses learned before.

        The lengths depend on the clock only where the time would be exceeded, so that answers are the same in each run.
        """
        propagations, length = float(_FIRST_PROPAGATIONS), 0.0
        while (left := self._end - time.monotonic()) > 0.0:
            if length > left:
                propagations *= left / length
            self._solver.prop_budget(max(1, int(propagations)))
            begin = time.monotonic()
            answer = self._solver.solve_limited(assumptions=assumed, expect_interrupt=True)
            if answer is not None:
                return bool(answer)
            propagations *= 2
            length = 2 * (time.monotonic() - begin)
        raise SolverTimeoutError

    def close(self) -> None:
        self._solver.delete()


class _Z3:
    """The SAT part of z3."""

    @staticmethod
    def load() -> Any:
        return import_module("z3")

    def __init__(self, seconds: float) -> None:
        self._z3 = self.load()
        self._solver = self._z3.SolverFor("QF_FD")
        self._variables: list[Any] = [None]
        self._end = time.monotonic() + seconds

    def _literal(self, literal: int) -> Any:
        while len(self._variables) <= abs(literal):
            self._variables.append(self._z3.Bool(f"v{len(self._variables)}"))
        variable = self._variables[abs(literal)]
        return variable if literal > 0 else self._z3.Not(variable)

    def add(self, clauses: list[Clause]) -> None:
        self._solver.add([self._z3.Or([self._literal(literal) for literal in clause]) for clause in clauses])

    def solve(self, assumed: Clause) -> set[int] | None:
        self._solver.set("timeout", max(1, int((self._end - time.monotonic()) * 1000)))
        answer = self._solver.check([self._literal(literal) for literal in assumed])
        if answer == self._z3.unknown:
            raise SolverTimeoutError
        if answer == self._z3.unsat:
            return None
        model = self._solver.model()
        return {
            number for number, variable in enumerate(self._variables) if number and self._z3.is_true(model[variable])
        }

    def close(self) -> None:
        self._solver = None


_SOLVERS: tuple[type[_PySat | _Z3], ...] = (_PySat, _Z3)
