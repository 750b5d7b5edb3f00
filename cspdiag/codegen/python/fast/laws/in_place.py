"""Inlined control laws: one run as assignments in the function of the process that runs it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from functools import cached_property
from math import ceil

from cspdiag.base.record import record
from cspdiag.codegen.python.fast.expressions import NANOSECONDS, FastPrinter
from cspdiag.codegen.python.fast.laws.integration import InlineIntegration, SubStep
from cspdiag.codegen.python.fast.statements import assigned, is_test, refused_unless_all_finite
from cspdiag.codegen.python.plain.external import ExternalModules, taken
from cspdiag.codegen.python.text.code import (
    PRODUCT,
    Argument,
    Call,
    Code,
    Constant,
    Name,
    WholeNumber,
    call,
    counted_to,
    infix,
)
from cspdiag.codegen.python.text.names import Names, identifier
from cspdiag.codegen.python.text.statements import For, Statement, assign
from cspdiag.codegen.python.text.types import real
from cspdiag.codegen.shared.equations import changes, defined, read_after_change
from cspdiag.network.ir.actions import RunLaw
from cspdiag.network.ir.declared import Declared
from cspdiag.network.ir.equations import ExternalCall, SubmodelEquation
from cspdiag.network.ir.faults import may_fault
from cspdiag.network.ir.network import ProcessClass, SubmodelState

_SECOND = 1_000_000_000


@record
class InlineLaw:
    """Writes one inlined control law.

    ``printer.signal`` gives the names of signals, constants, states and objects of external bodies, both to read and to
    assign. ``names`` makes the further local variables that are needed; ``place`` gives the source place of a
    declaration.
    """

    law: RunLaw
    class_: ProcessClass
    printer: FastPrinter
    names: Names
    place: Callable[[Declared], str]
    modules: ExternalModules

    def prologue(self) -> Iterable[Statement]:
        """What is computed once, before the first run and after the constants of the class: the sub-step, if it is not
        known.
        """
        if not self._continuous or isinstance(self._sample, float):
            return
        step = self._sub_step
        assert self.law.sample is not None
        sample = self.printer.print(self.law.sample)
        if self.law.step is not None:
            duration = call("round", infix("*", PRODUCT, sample, NANOSECONDS))
            count = infix("/", PRODUCT, duration, Constant(f"{self.law.step:_}"))
            yield assign(self._steps, call(self.printer.imports.standard("math", "ceil"), count))
            sample = infix("/", PRODUCT, sample, self._steps)
        yield assign(step.whole, sample)
        if self.law.method == "rk4":
            yield assign(step.half, infix("/", PRODUCT, step.whole, WholeNumber(2)))
            yield assign(step.sixth, infix("/", PRODUCT, step.whole, WholeNumber(6)))

    def statements(self) -> Iterable[Statement]:
        """One run: the equations, then the integration, then the next values, each computed from the states before the
        run.
        """
        yield from self._equations()
        moved: list[Statement] = []
        if self._continuous:
            yield from self._integrated(moved)
        before = {name: self.names.fresh(f"{name}_before") for name in read_after_change(self.law.next_values)}
        for name, local in before.items():
            yield assign(local, self.printer.signal(name))
        changed: set[str] = set()

        def late(name: str) -> Code:
            return Name(before[name]) if name in before and name in changed else self.printer.signal(name)

        printer = replace(self.printer, signal=late)
        for name, value in self.law.next_values:
            yield from assigned(self.printer.signal(name), printer, value, self._place_of_state(name))
            changed.add(name)
        yield from moved

    def _equations(self) -> Iterable[Statement]:
        """The equations, and tests of those that must be finite, together as far as no other fault can come between."""
        untested: list[tuple[Code, str | None]] = []
        for equation in self.law.equations:
            if isinstance(equation, ExternalCall):
                yield from refused_unless_all_finite(untested, self.printer.imports)
                untested = []
                yield from self._called(equation)
                continue
            target, value, place = self.printer.signal(equation.name), equation.value, self.place(equation)
            is_tested = is_test(value)
            computed = value.arguments[0] if is_test(value) else value
            if may_fault(computed):
                yield from refused_unless_all_finite(untested, self.printer.imports)
                untested = []
            yield from assigned(target, self.printer, computed, place)
            if is_tested:
                untested.append((target, place))
        yield from refused_unless_all_finite(untested, self.printer.imports)

    def finite_signals(self) -> list[Code]:
        """The signals that are finite, or a run has raised a fault."""
        equations = [item for item in self.law.equations if isinstance(item, SubmodelEquation)]
        return [self.printer.signal(item.name) for item in equations if is_test(item.value)]

    def _called(self, item: ExternalCall) -> Iterator[Statement]:
        given = tuple(Argument(self.printer.print(value), identifier(port)) for port, value in item.inputs)
        calculated = Call(self.printer.signal(item.name).field("calculate"), given)
        outputs = [(self.printer.signal(local), type_) for _, local, type_ in item.outputs]
        return taken(outputs, calculated, self.printer.imports, self.place(item))

    @cached_property
    def _changes(self) -> dict[str, SubmodelState]:
        return changes(self.class_, self.law)

    def _place_of_state(self, name: str) -> str | None:
        return self.place(self._changes[name]) if name in self._changes else None

    # Integration

    @property
    def _continuous(self) -> list[str]:
        return [name for name, _ in self.law.derivatives]

    @cached_property
    def _sample(self) -> float | None:
        """The sample period in seconds, if it is known."""
        value = None if self.law.sample is None else self.printer.value(self.law.sample)
        return value if isinstance(value, float) else None

    @cached_property
    def _known_steps(self) -> int | None:
        """The number of sub-steps in a sample, if it is known."""
        if self._sample is None or self.law.step is None:
            return None if self._sample is None else 1
        return ceil(round(self._sample * _SECOND) / self.law.step)

    @cached_property
    def _steps(self) -> Code:
        """The number of sub-steps in a sample."""
        known = self._known_steps
        return Name(self.names.fresh(f"{self.law.law}_steps")) if known is None else Constant(str(known))

    @cached_property
    def _sub_step(self) -> SubStep:
        if self._sample is None:
            made = (self.names.fresh(f"{self.law.law}_{part}") for part in ("h", "half", "sixth"))
            return SubStep(*map(Name, made))
        h = self._sample / (self._known_steps or 1)
        return SubStep(real(h), real(h / 2), real(h / 6))

    def _integrated(self, moved: list[Statement]) -> Iterable[Statement]:
        """Integrate in copies of the states; ``moved`` gets the assignments to the states themselves, once no more
        faults are possible.
        """
        local = {name: self.names.fresh(f"{name}_moved") for name in self._continuous}
        for name, copy in local.items():
            yield assign(copy, self.printer.signal(name))
        inline = InlineIntegration(
            states=self._continuous,
            equations=self.law.derivative_equations,
            derivatives=dict(self.law.derivatives),
            changes=self._changes,
            method=self.law.method,
            printer=self.printer,
            local=local.__getitem__,
            names=self.names,
            place=self.place,
            step=self._sub_step,
        )
        if self.law.step is None or self._known_steps == 1:
            yield from inline.statements()
        else:
            yield For("_", counted_to(self._steps), tuple(inline.statements()))
        copies = [(Name(copy), self._place_of_state(name)) for name, copy in local.items()]
        yield from refused_unless_all_finite(copies, self.printer.imports)
        moved += [assign(self.printer.signal(name), Name(copy)) for name, copy in local.items()]


def reset_statements(
    names: Iterable[str], class_: ProcessClass, printer: FastPrinter, place: Callable[[Declared], str]
) -> Iterable[Statement]:
    """Reset states of a class to their initial values."""
    states = {state.name: state for state in class_.states}
    for name in names:
        state = states.get(name)
        if state is not None:
            yield from assigned(printer.signal(name), printer, state.initial, place(state))


def signals_of(law: RunLaw) -> set[str]:
    """The signals that the equations of a law define."""
    return {name for equation in law.equations for name in defined(equation)}
