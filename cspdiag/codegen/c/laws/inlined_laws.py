"""Inlined control laws as C: the statements, on members of the process, that run a law or reset it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cached_property

from cspdiag.base.record import record
from cspdiag.codegen.c.laws.calls import body_name
from cspdiag.codegen.c.laws.equations import Check, EquationWriter, LocalVariable, Target, record_fault_place
from cspdiag.codegen.c.laws.integration import Integration, sub_steps
from cspdiag.codegen.c.text.code import PRODUCT, Code, cast, code, infix
from cspdiag.codegen.c.text.expressions import Printer
from cspdiag.codegen.c.text.names import INTEGRATION_LOCALS, Names, identifier
from cspdiag.codegen.c.text.statements import Block, Statement, define, store
from cspdiag.codegen.shared.laws.equations import changes, read_after_change, signals, values
from cspdiag.model.types import Type
from cspdiag.network.ir.actions import RunLaw
from cspdiag.network.ir.declared import Declared
from cspdiag.network.ir.equations import ExternalCall
from cspdiag.network.ir.network import ProcessClass, SubmodelState


@record
class InlinedLaw:
    """One run of a law: functions to define before the step function, and the statements, as a block of their own."""

    functions: list[Statement]
    statements: list[Statement]
    unread: frozenset[str]
    """Signals that the run computes but does not read."""


def run_law_signals(action: RunLaw) -> list[tuple[str, Type]]:
    """The signals that a run computes, for the process to declare."""
    found: list[tuple[str, Type]] = []
    for equation in action.equations:
        if isinstance(equation, ExternalCall):
            found += [(local, type_) for _, local, type_ in equation.outputs]
        else:
            found.append((equation.name, equation.type))
    return found


def run_law(
    action: RunLaw,
    class_: ProcessClass,
    *,
    owner: str,
    printer: Printer,
    place: Callable[[Declared], str],
    check: Check,
    types_of: Mapping[str, Type],
    local: Mapping[str, str],
) -> InlinedLaw:
    """The statements of one run.

    ``printer.signal`` gives the lvalues of signals, states and constants; ``types_of`` their types, including those of
    inputs read earlier. ``owner`` is the struct of the process. ``check`` gives the statements that check for a fault
    after a statement, from its place. ``local`` are the signals that only this run needs, with the names under which
    it defines them.
    """
    return _Run(action, class_, owner, printer, place, check, dict(types_of), local).result()


def reset_states(states: tuple[str, ...], class_: ProcessClass, writer: EquationWriter) -> list[Statement]:
    """The statements that reset states of a process."""
    by_name = {state.name: state for state in class_.states}
    statements: list[Statement] = []
    for name in states:
        if name in by_name:
            statements += writer.reset(writer.printer.signal(name), by_name[name])
    return statements


@record
class _Run:
    action: RunLaw
    class_: ProcessClass
    owner: str
    printer: Printer
    place: Callable[[Declared], str]
    check: Check
    types_of: dict[str, Type]
    local: Mapping[str, str]

    def result(self) -> InlinedLaw:
        action = self.action
        hoisted = self._hoisted()
        copies = {name: f"{identifier(name)}_before" for name in hoisted}
        statements = self._writer(self.printer).equations(action.equations, self._target)
        late = replace(
            self.printer, signal=lambda name: code(copies[name]) if name in copies else self.printer.signal(name)
        )
        last: list[Statement] = [
            define(f"const {self._type_name(name)}", copies[name], self.printer.signal(name)) for name in hoisted
        ]
        following: list[Statement] = []
        for name, value in action.next_values:
            following += self._writer(late).assign(self.printer.signal(name), value, self._state_place(name))
        functions: list[Statement] = []
        if action.derivatives:
            integration = self._integration
            last += self._integration_statements(integration, following)
            functions = integration.function(self._slopes_printer(integration), self._slopes_writer(integration))
        else:
            last += following
        # The copies have a block of their own: the same law may run several times in one function.
        statements += [Block(tuple(last))] if hoisted else last
        return InlinedLaw(functions, statements, self._unread())

    def _type_name(self, name: str) -> str:
        return self.printer.types.type_name(self.types_of[name])

    def _target(self, name: str) -> Target:
        if name in self.local:
            return LocalVariable(f"const {self._type_name(name)}", self.local[name])
        return self.printer.signal(name)

    def _unread(self) -> frozenset[str]:
        """What derivatives need and compute themselves in every sub-step is not read."""
        action = self.action
        read = {*signals((*(values(equation) for equation in action.equations), action.next_values))}
        if action.derivatives:
            read.update(self._integration.held)
        return frozenset(name for name, _ in run_law_signals(action)) - read

    def _writer(self, printer: Printer) -> EquationWriter:
        return EquationWriter(printer, self.place, self.check, self.printer.signal, body_name)

    @cached_property
    def _changes(self) -> dict[str, SubmodelState]:
        return changes(self.class_, self.action)

    def _state_place(self, name: str) -> str:
        return self.place(self._changes[name])

    def _hoisted(self) -> list[str]:
        """States that are read after they have changed."""
        late = read_after_change(self.action.next_values)
        return [name for name, _ in self.action.next_values if name in late]

    @cached_property
    def _integration(self) -> Integration:
        action = self.action
        states = tuple(name for name, _ in action.derivatives)
        moving = {*states, *(equation.name for equation in action.derivative_equations)}
        own = {item.name for item in self.class_.constants}
        read = signals((action.derivatives, tuple(equation.value for equation in action.derivative_equations)))
        names = Names({*INTEGRATION_LOCALS, *self.printer.types.names.globals})
        signal_types = {**self.types_of, **{equation.name: equation.type for equation in action.derivative_equations}}
        return Integration(
            name=f"{self.owner}_{identifier(action.law)}_slopes",
            owner=self.owner,
            local=lambda name: names[name.removeprefix(f"{action.law}.")],
            types=signal_types,
            states=states,
            held=tuple(name for name in read if name not in moving and name not in own),
            equations=action.derivative_equations,
            derivatives=action.derivatives,
            changes=self._changes,
            method=action.method,
        )

    def _slopes_printer(self, integration: Integration) -> Printer:
        inner = {*integration.states, *integration.held, *(item.name for item in integration.equations)}
        return Printer(
            self.printer.types,
            parameter=self.printer.parameter,
            variable=self.printer.variable,
            signal=lambda name: code(integration.local(name)) if name in inner else self.printer.signal(name),
        )

    def _slopes_writer(self, integration: Integration) -> EquationWriter:
        return EquationWriter(
            self._slopes_printer(integration), self.place, record_fault_place, self.printer.signal, body_name
        )

    def _integration_statements(self, integration: Integration, following: list[Statement]) -> list[Statement]:
        """The block that integrates; all states are assigned at its end, after the last operation that can fault."""
        action = self.action
        assert action.sample is not None
        statements: list[Statement] = []
        for state in integration.states:
            type_name = self.printer.types.type_name(self.types_of[state])
            statements.append(define(type_name, integration.local(state), self.printer.signal(state)))
        sample = self.printer.plain(action.sample)
        count: Code | None = None
        if action.step is None:
            statements.append(define("const double", "h", sample))
        else:
            count = code("steps")
            statements.append(define("const int64_t", "steps", sub_steps(sample, float(action.step))))
            statements.append(define("const double", "h", infix("/", PRODUCT, sample, cast("double", count))))
        statements += integration.steps(self.printer.signal, count)
        places = [self._state_place(state) for state in integration.states]
        statements += [*integration.check(places, self.check), *following]
        for state in integration.states:
            integrated = code(integration.local(state))
            statements.append(store(self.printer.signal(state), integrated))
        return [Block(tuple(statements))]
