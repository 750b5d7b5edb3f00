"""Control laws that were inlined into a process: their runs and resets as C statements on members of the process."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

from cspdiag.base.record import record
from cspdiag.codegen.c.laws.equations import Check, EquationWriter
from cspdiag.codegen.c.laws.integration import LOCALS, Integration
from cspdiag.codegen.c.laws.laws import body_name
from cspdiag.codegen.c.text.code import INDENT
from cspdiag.codegen.c.text.expressions import Printer
from cspdiag.codegen.c.text.literals import quoted
from cspdiag.codegen.c.text.names import Names, identifier
from cspdiag.codegen.shared.equations import signals, values
from cspdiag.model.types import RealType, Type
from cspdiag.network.ir.actions import RunLaw
from cspdiag.network.ir.declared import Declared
from cspdiag.network.ir.equations import ExternalCall
from cspdiag.network.ir.faults import may_fault
from cspdiag.network.ir.network import ProcessClass


@record
class InlinedLaw:
    """One run of a law: functions to stand before the step function, and the statements (a block of their own)."""

    functions: list[str]
    lines: list[str]


def run_law_signals(action: RunLaw) -> list[tuple[str, Type]]:
    """The signals that a run makes, for the process to declare."""
    found: list[tuple[str, Type]] = []
    for equation in action.equations:
        if isinstance(equation, ExternalCall):
            found += [(local, type_) for _, local, type_ in equation.outputs]
        else:
            found.append((equation.name, equation.type))
    return found


def run_law_may_fault(action: RunLaw) -> bool:
    """Whether a run can fault."""
    items = [part for equation in action.equations for part in values(equation)]
    items += [value for _, value in action.next_values]
    return bool(action.derivatives) or any(map(may_fault, items))


def run_law(
    action: RunLaw,
    class_: ProcessClass,
    *,
    owner: str,
    printer: Printer,
    place: Callable[[Declared], str],
    check: Check,
    types_of: Mapping[str, Type],
    indent: str = "",
) -> InlinedLaw:
    """The statements of one run.

    ``printer.signal`` gives the lvalues of signals, states and constants; ``types_of`` their types, inputs read before included. ``owner`` is
    the struct of the process. ``check`` gives the lines that look for a fault behind a statement of a place.
    """
    return _Run(action, class_, owner, printer, place, check, dict(types_of), indent).result()


def reset_states(states: tuple[str, ...], class_: ProcessClass, printer: Printer, indent: str = "") -> list[str]:
    """The statements that put states of a process, and nested bodies in C, back."""
    by_name = {state.name: state for state in class_.states}
    rows: list[str] = []
    for name in states:
        if name in by_name:
            state = by_name[name]
            code = printer.print(state.initial)
            rows += [f"{indent}{declaration}" for declaration in printer.take_temporaries()]
            rows.append(f"{indent}{printer.signal(name)} = {code};")
    return rows


@record
class _Run:
    action: RunLaw
    class_: ProcessClass
    owner: str
    printer: Printer
    place: Callable[[Declared], str]
    check: Check
    types_of: dict[str, Type]
    indent: str

    def result(self) -> InlinedLaw:
        action, indent = self.action, self.indent
        hoisted = self._hoisted()
        copies = {name: f"{identifier(name)}_before" for name in hoisted}
        rows = self._writer(self.printer, indent).equations(action.equations, self.printer.signal)
        if hoisted:
            # The copies have a block of their own: the same law may run in several places of one function.
            rows.append(f"{indent}{{")
            indent += INDENT
        for name in hoisted:
            kind = self.printer.types.type_name(self.types_of[name])
            rows.append(f"{indent}const {kind} {copies[name]} = {self.printer.signal(name)};")
        late = replace(self.printer, signal=lambda name: copies.get(name) or self.printer.signal(name))
        following: list[str] = []
        inner = indent + INDENT if action.derivatives else indent
        for name, value in action.next_values:
            following += self._writer(late, inner).assign(self.printer.signal(name), value, self._state_place(name))
        functions: list[str] = []
        if action.derivatives:
            integration = self._integration()
            rows += self._integrated(integration, following, indent)
            functions = integration.function(self._slopes_printer(integration), self._slopes_writer(integration))
        else:
            rows += following
        return InlinedLaw(functions, [*rows, f"{self.indent}}}"] if hoisted else rows)

    def _writer(self, printer: Printer, indent: str) -> EquationWriter:
        return EquationWriter(printer, self.place, self.check, self.printer.signal, body_name, indent)

    def _state_place(self, name: str) -> str:
        return next(self.place(state) for state in self.class_.states if state.name == name)

    def _hoisted(self) -> list[str]:
        """States that are read after they have changed."""
        changed: set[str] = set()
        late: set[str] = set()
        for name, value in self.action.next_values:
            late |= set(signals((value,))) & changed
            changed.add(name)
        return [name for name, _ in self.action.next_values if name in late]

    def _integration(self) -> Integration:
        action = self.action
        states = tuple(name for name, _ in action.derivatives)
        moving = {*states, *(equation.name for equation in action.derivative_equations)}
        own = {item.name for item in self.class_.constants}
        read = signals((action.derivatives, tuple(equation.value for equation in action.derivative_equations)))
        names = Names({*LOCALS, *self.printer.types.names.globals})
        kinds = {**self.types_of, **{equation.name: equation.type for equation in action.derivative_equations}}
        return Integration(
            name=f"{self.owner}_{identifier(action.law)}_slopes",
            owner=self.owner,
            local=lambda name: names[name.removeprefix(f"{action.law}.")],
            types=kinds,
            states=states,
            held=tuple(name for name in read if name not in moving and name not in own),
            equations=action.derivative_equations,
            derivatives=action.derivatives,
            method=action.method,
        )

    def _slopes_printer(self, integration: Integration) -> Printer:
        inner = {*integration.states, *integration.held, *(item.name for item in integration.equations)}
        return Printer(
            self.printer.types,
            parameter=self.printer.parameter,
            variable=self.printer.variable,
            signal=lambda name: integration.local(name) if name in inner else self.printer.signal(name),
        )

    def _slopes_writer(self, integration: Integration) -> EquationWriter:
        def check(place: str) -> list[str]:
            return [f"csp_fault_in({quoted(place)});"] if place else []

        return EquationWriter(
            self._slopes_printer(integration), self.place, check, self.printer.signal, body_name, INDENT
        )

    def _integrated(self, integration: Integration, following: list[str], indent: str) -> list[str]:
        """The block that integrates; all states take their values at its end, when nothing can fault any more."""
        action, deeper = self.action, indent + INDENT
        assert action.sample is not None
        rows = [f"{indent}{{"]
        for state in integration.states:
            rows.append(f"{deeper}double {integration.local(state)} = {self.printer.signal(state)};")
        sample = self.printer.print(action.sample)
        count: str | None = None
        if action.step is None:
            rows.append(f"{deeper}const double h = {sample};")
        else:
            count = "steps"
            rows.append(f"{deeper}const int64_t steps = (int64_t)ceil(rint({sample} * 1e9) / {float(action.step)!r});")
            rows.append(f"{deeper}const double h = {sample} / (double)steps;")
        rows += integration.steps(self._slopes_printer(integration), self.printer.signal, count, deeper)
        for state in integration.states:
            rows.append(f"{deeper}{integration.local(state)} = csp_real({integration.local(state)});")
        rows += [deeper + row for row in self.check(self.place(action.equations[-1]) if action.equations else "")]
        rows += following
        for state in integration.states:
            single = isinstance(self.types_of[state], RealType) and self.types_of[state] == RealType(32)
            cast = "(float)" if single else ""
            rows.append(f"{deeper}{self.printer.signal(state)} = {cast}{integration.local(state)};")
        return [*rows, f"{indent}}}"]
