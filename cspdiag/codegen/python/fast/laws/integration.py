"""The inlined integration of continuous states: one sub-step as plain assignments.

The operations and their order are those of ``-O0``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Literal

from cspdiag.base.record import record
from cspdiag.codegen.python.fast.expressions import FastPrinter
from cspdiag.codegen.python.fast.statements import assigned
from cspdiag.codegen.python.plain.laws.integration import rounded
from cspdiag.codegen.python.text.code import PRODUCT, SUM, Code, Constant, Name
from cspdiag.codegen.python.text.names import Names
from cspdiag.codegen.python.text.operators import infix
from cspdiag.codegen.python.text.statements import Statement, assign, change
from cspdiag.codegen.shared.laws.equations import needed, signals, uses_time
from cspdiag.model.types import is_single
from cspdiag.network.ir.declared import Declared
from cspdiag.network.ir.equations import SubmodelEquation
from cspdiag.network.ir.expressions import Expression
from cspdiag.network.ir.faults import may_fault
from cspdiag.network.ir.network import SubmodelState


@record
class SubStep:
    """A sub-step in seconds, and the fractions of it that Runge-Kutta needs: local variables or values."""

    whole: Code
    half: Code
    sixth: Code


@record
class InlineIntegration:
    """Writes the sub-step of states that are local variables.

    ``states`` are their names in the text, in order, and ``local`` gives the local variable of each. ``step`` is the
    sub-step in seconds; if the derivatives depend on time, the local variable ``t`` is the instant in seconds at which
    it begins. ``names`` makes the further variables that are needed. ``changes`` has the place of each derivative.
    """

    states: Sequence[str]
    equations: Sequence[SubmodelEquation]
    derivatives: Mapping[str, Expression]
    changes: Mapping[str, SubmodelState]
    method: Literal["rk4", "euler"]
    printer: FastPrinter
    local: Callable[[str], str]
    names: Names
    place: Callable[[Declared], str]
    step: SubStep

    @property
    def timed(self) -> bool:
        """Whether the derivatives depend on the present instant."""
        return uses_time((tuple(self.derivatives.values()), tuple(self.equations)))

    def statements(self) -> Iterable[Statement]:
        """One sub-step."""
        stages = 1 if self.method == "euler" else 4
        slopes = [
            [self.names.fresh(f"k{stage}_{self.local(name)}") for name in self.states] for stage in range(1, stages + 1)
        ]
        for stage in range(stages):
            yield from self._stage(stage, slopes)
        for state, *k in zip(self.states, *slopes, strict=True):
            local, by = self.local(state), self._advance(k)
            if is_single(self.changes[state].type):
                yield assign(local, self._rounded(state, infix("+", SUM, Name(local), by)))
            else:
                yield change(local, "+=", by)

    def _rounded(self, state: str, value: Code) -> Code:
        return rounded(value, self.changes[state].type, self.printer.imports)

    def _stage(self, stage: int, slopes: Sequence[Sequence[str]]) -> Iterable[Statement]:
        fraction = (None, self.step.half, self.step.half, self.step.whole)[stage]
        at = {name: self.local(name) for name in self.states}
        if fraction is not None:
            at.update(self._between)
            for name, slope in zip(self.states, slopes[stage - 1], strict=True):
                if name in self._between:
                    moved = infix("*", PRODUCT, fraction, Name(slope))
                    yield assign(at[name], self._rounded(name, infix("+", SUM, Name(self.local(name)), moved)))
        outer = self.printer.signal

        def signal(name: str) -> Code:
            local = at.get(name) or self._locals.get(name)
            return outer(name) if local is None else Name(local)

        time = Name("t") if fraction is None else infix("+", SUM, Name("t"), fraction)
        printer = replace(self.printer, signal=signal, time=time)
        for equation in self._needed:
            yield from assigned(Name(self._locals[equation.name]), printer, equation.value, self.place(equation))
        for name, slope in zip(self.states, slopes[stage], strict=True):
            value = self.derivatives[name]
            yield assign(slope, printer.print(value), self.place(self.changes[name]) if may_fault(value) else None)

    @cached_property
    def _needed(self) -> list[SubmodelEquation]:
        wanted = signals((tuple(self.derivatives.values()),))
        return [item for item in needed(self.equations, wanted) if isinstance(item, SubmodelEquation)]

    @cached_property
    def _locals(self) -> dict[str, str]:
        """Names for the equations within the sub-step, because those of the sample are still needed."""
        return {item.name: self.names.fresh(f"{item.name}_within") for item in self._needed}

    @cached_property
    def _between(self) -> dict[str, str]:
        """Names for the states within the sub-step that the derivatives read."""
        read = signals((tuple(self.derivatives.values()), tuple(item.value for item in self._needed)))
        return {name: self.names.fresh(f"{name}_at") for name in self.states if name in read}

    def _advance(self, k: Sequence[str]) -> Code:
        if len(k) == 1:
            return infix("*", PRODUCT, self.step.whole, Name(k[0]))
        k1, k2, k3, k4 = k
        total = infix("+", SUM, Name(k1), infix("*", PRODUCT, Constant("2.0"), Name(k2)))
        total = infix("+", SUM, total, infix("*", PRODUCT, Constant("2.0"), Name(k3)))
        return infix("*", PRODUCT, self.step.sixth, infix("+", SUM, total, Name(k4)))
