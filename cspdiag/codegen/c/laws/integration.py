"""The integration of continuous states over one sample, in the order of operations of every target."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property

from cspdiag.base.record import record
from cspdiag.codegen.c.laws.equations import EquationWriter
from cspdiag.codegen.c.text.code import INDENT, Code, broken, statement
from cspdiag.codegen.c.text.expressions import Printer
from cspdiag.codegen.shared.equations import Equation, needed, signals, uses_time, values
from cspdiag.model.types import Type
from cspdiag.network.ir.equations import SubmodelEquation
from cspdiag.network.ir.expressions import Expression
from cspdiag.network.ir.faults import may_fault

LOCALS = frozenset(["h", "half", "sixth", "step", "steps", "t", "time", "k1", "k2", "k3", "k4", "slope", "slopes"])
"""Names that an integration uses itself."""


@record
class Integration:
    """Writes the slopes of continuous states as a function, and the Runge-Kutta (or Euler) step that calls it.

    ``name`` is the function's; ``owner`` the struct that has constants and parameters. ``local`` gives the C name of every signal that moves or is
    held, ``types`` their types; ``states`` are the continuous states and ``held`` what else the slopes read that does not change meanwhile.
    """

    name: str
    owner: str
    local: Callable[[str], str]
    types: dict[str, Type]
    states: tuple[str, ...]
    held: tuple[str, ...]
    equations: tuple[SubmodelEquation, ...]
    derivatives: tuple[tuple[str, Expression], ...]
    method: str

    @property
    def timed(self) -> bool:
        """Whether the slopes depend on the present instant."""
        return uses_time((self.derivatives, self.equations))

    @property
    def faulty(self) -> bool:
        """Whether their evaluation can fault."""
        values = [value for _, value in self.derivatives]
        return any(may_fault(value) for value in (*values, *(equation.value for equation in self.equations)))

    @property
    def several(self) -> bool:
        """Whether there is more than one state, so that slopes are a struct."""
        return len(self.states) > 1

    @cached_property
    def _read(self) -> frozenset[str]:
        """The signals that the slopes depend on."""
        equations = needed(self.equations, signals((self.derivatives,)))
        return frozenset(signals((self.derivatives, tuple(part for item in equations for part in values(item)))))

    @property
    def _states_read(self) -> list[str]:
        return [state for state in self.states if state in self._read]

    @property
    def _held_read(self) -> list[str]:
        return [name for name in self.held if name in self._read]

    def function(self, printer: Printer, writer: EquationWriter) -> list[str]:
        """The function that evaluates the slopes. A fault is noted with its place, and whoever calls looks for it."""
        result = f"struct {self.name}" if self.several else "double"
        rows: list[str] = []
        if self.several:
            rows += [f"struct {self.name} {{"]
            rows += [f"{INDENT}double {self.local(state)};" for state in self.states]
            rows += ["};", ""]
        uses_self = self._mentions_owner(printer)
        parameters = [f"const struct {self.owner} *self"] if uses_self else []
        parameters += [f"double {self.local(state)}" for state in self._states_read]
        parameters += [f"{printer.types.type_name(self.types[name])} {self.local(name)}" for name in self._held_read]
        parameters += ["double time"] if self.timed else []
        head = f"static inline {result} {self.name}({', '.join(parameters) or 'void'})"
        rows += [*broken(head, INDENT * 2), "{"]
        equations: list[Equation] = list(needed(self.equations, signals((self.derivatives,))))
        kinds = {equation.name: equation.type for equation in self.equations}
        rows += writer.equations(
            equations, lambda name: f"const {printer.types.type_name(kinds[name])} {self.local(name)}"
        )
        by_state = dict(self.derivatives)
        # As everywhere, what has no place of its own is told at that of the statement before.
        place = writer.place(equations[-1]) if equations else ""
        if not self.several:
            value = by_state[self.states[0]]
            rows += self._result(value, "const double slope", place, writer)
            rows += [f"{INDENT}return slope;", "}"]
            return rows
        rows += [f"{INDENT}struct {self.name} slopes;"]
        for state in self.states:
            rows += self._result(by_state[state], f"slopes.{self.local(state)}", place, writer)
        return [*rows, f"{INDENT}return slopes;", "}"]

    @staticmethod
    def _result(value: Expression, target: str, place: str, writer: EquationWriter) -> list[str]:
        rows = writer.assign_code(target, writer.printer.print(value), None, faulty=False)
        return [*rows, *(INDENT + row for row in (writer.check(place) if may_fault(value) else []))]

    def _mentions_owner(self, printer: Printer) -> bool:
        values = [value for _, value in self.derivatives] + [equation.value for equation in self.equations]
        mentions = any("self->" in printer.print(value).text for value in values)
        printer.take_temporaries()
        return mentions

    def steps(
        self, printer: Printer, outer: Callable[[str], str], count: str | None, indent: str, owner: str = "self"
    ) -> list[str]:
        """The statements that move the states, which are local variables, over ``count`` sub-steps of ``h`` seconds.

        ``printer`` is that of the function, ``outer`` gives the lvalues of what is held where the statements stand.
        """
        shared = [owner] if self._mentions_owner(printer) else []
        kept = [outer(name) for name in self._held_read]
        inner = indent + INDENT if count is not None else indent
        rows: list[str] = []
        if self.method != "euler":
            rows += [f"{indent}const double half = h / 2.0;"] if self._states_read or self.timed else []
            rows += [f"{indent}const double sixth = h / 6.0;"]
        if count is not None:
            rows += [f"{indent}for (int64_t step = 0; step < {count}; step++) {{"]
        if self.timed:
            rows += [f"{inner}const double t = time{' + (double)step * h' if count is not None else ''};"]
        rows += (self._euler if self.method == "euler" else self._runge_kutta)(shared, kept, inner)
        return [*rows, f"{indent}}}"] if count is not None else rows

    def _slope(self, stage: str, state: str) -> str:
        return f"{stage}.{self.local(state)}" if self.several else stage

    def _evaluated(
        self, stage: str, at: Sequence[str], time: str, shared: list[str], kept: list[str], indent: str
    ) -> list[str]:
        arguments = [*shared, *at, *kept, *([time] if self.timed else [])]
        kind = f"const struct {self.name} {stage}" if self.several else f"const double {stage}"
        return statement(f"{kind} = ", Code(f"{self.name}({', '.join(arguments)})"), ";", indent)

    def _euler(self, shared: list[str], kept: list[str], indent: str) -> list[str]:
        states = [self.local(state) for state in self._states_read]
        rows = self._evaluated("k1", states, "t", shared, kept, indent)
        return [*rows, *(f"{indent}{self.local(state)} += h * {self._slope('k1', state)};" for state in self.states)]

    def _runge_kutta(self, shared: list[str], kept: list[str], indent: str) -> list[str]:
        rows: list[str] = []
        for stage, fraction in enumerate(("", "half", "half", "h")):
            at = [self.local(state) for state in self._states_read]
            time = "t"
            if fraction:
                before = f"k{stage}"
                at = [f"{self.local(state)} + {fraction} * {self._slope(before, state)}" for state in self._states_read]
                time = f"t + {fraction}"
            rows += self._evaluated(f"k{stage + 1}", at, time, shared, kept, indent)
        for state in self.states:
            k1, k2, k3, k4 = (self._slope(f"k{stage}", state) for stage in (1, 2, 3, 4))
            total = Code(f"sixth * ({k1} + 2.0 * {k2} + 2.0 * {k3} + {k4})")
            rows += statement(f"{self.local(state)} += ", total, ";", indent)
        return rows
