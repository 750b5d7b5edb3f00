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
    COMPARISON,
    NONE,
    OR,
    PRODUCT,
    Argument,
    Call,
    Code,
    Constant,
    Name,
    WholeNumber,
    call,
    counted_to,
)
from cspdiag.codegen.python.text.names import Names, identifier
from cspdiag.codegen.python.text.operators import infix, infix_all
from cspdiag.codegen.python.text.statements import Assign, For, Statement, assign, if_
from cspdiag.codegen.python.text.types import annotation, real
from cspdiag.codegen.shared.laws.equations import changes, defined, read_after_change
from cspdiag.codegen.shared.laws.following import Following, following_apart
from cspdiag.model.types import Type
from cspdiag.network.ir.actions import RunLaw
from cspdiag.network.ir.declared import Declared
from cspdiag.network.ir.equations import ExternalCall, SubmodelEquation
from cspdiag.network.ir.expressions import TunableValue
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
        known; and that nothing has been computed from parameters of the program yet.
        """
        for parameter, present in zip(self._following.parameters, self._present, strict=True):
            yield Assign(present, NONE, annotation=f"{annotation(parameter.type, self.printer.imports)} | None")
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
        yield from self._followed()
        yield from self._equations(self._following.law.equations)
        moved: list[Statement] = []
        if self._continuous:
            yield from self._integrated(moved)
        before = {name: self.names.fresh(f"{name}_before") for name in read_after_change(self.law.next_values)}
        for name, local in before.items():
            yield assign(local, self.printer.signal(name))
        changed: set[str] = set()

        def late(name: str) -> Code:
            return Name(before[name]) if name in before and name in changed else self._printer.signal(name)

        printer = replace(self.printer, signal=late)
        for name, value in self._following.law.next_values:
            yield from assigned(self.printer.signal(name), printer, value, self._place_of_state(name))
            changed.add(name)
        yield from moved

    # What follows parameters of the program

    @cached_property
    def _following(self) -> Following:
        return following_apart(self.law, frozenset(item.name for item in self.class_.constants))

    @cached_property
    def _present(self) -> list[Name]:
        """Of each parameter that the law uses the value from which the rest was computed, as a local variable."""
        return [Name(self.names.fresh(f"{self.law.law}_{item.name}")) for item in self._following.parameters]

    @cached_property
    def _terms(self) -> dict[str, Name]:
        """The local variable of each term; for one that is a parameter, the variable with its value."""
        following = self._following
        present = dict(zip(following.parameters, self._present, strict=True))
        return {
            term.name: present[term.value]
            if isinstance(term.value, TunableValue)
            else Name(self.names.fresh(term.name.rpartition(" ")[0]))
            for term in following.terms
        }

    @cached_property
    def _computed_terms(self) -> list[SubmodelEquation]:
        return [term for term in self._following.terms if not isinstance(term.value, TunableValue)]

    @cached_property
    def _printer(self) -> FastPrinter:
        """Prints expressions with terms that follow parameters."""
        return replace(self.printer, signal=lambda name: self._terms.get(name) or self.printer.signal(name))

    def kept(self) -> Iterator[tuple[str, Type]]:
        """The further local variables that keep their values from one run to the next."""
        following = self._following
        for item in following.equations:
            signal = self.printer.signal(item.name)
            assert isinstance(signal, Name)  # A local variable.
            yield signal.text, item.type
        for term in self._computed_terms:
            yield self._terms[term.name].text, term.type

    def present(self) -> Iterator[str]:
        """The local variables that tell whether a parameter has changed."""
        return (name.text for name in self._present)

    def _followed(self) -> Iterator[Statement]:
        """Compute what follows parameters of the program again, if one of them has changed."""
        following = self._following
        if not following.parameters:
            return
        values = [self.printer.print(item) for item in following.parameters]
        pairs = list(zip(values, self._present, strict=True))
        changed = [infix("is not", COMPARISON, value, present) for value, present in pairs]
        terms = (assign(self._terms[item.name], self.printer.print(item.value)) for item in self._computed_terms)
        yield if_(
            infix_all("or", OR, changed),
            *self._equations(following.equations),
            *terms,
            *(assign(present, value) for value, present in pairs),
        )

    # One run

    def _equations(self, equations: Iterable[SubmodelEquation | ExternalCall]) -> Iterable[Statement]:
        """Equations, and tests of those that must be finite, together as far as no other fault can come between."""
        untested: list[tuple[Code, str | None]] = []
        for equation in equations:
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
            yield from assigned(target, self._printer, computed, place)
            if is_tested:
                untested.append((target, place))
        yield from refused_unless_all_finite(untested, self.printer.imports)

    def finite_signals(self) -> list[Code]:
        """The signals that are finite, or a run has raised a fault."""
        equations = [item for item in self.law.equations if isinstance(item, SubmodelEquation)]
        return [self.printer.signal(item.name) for item in equations if is_test(item.value)]

    def _called(self, item: ExternalCall) -> Iterator[Statement]:
        given = tuple(Argument(self._printer.print(value), identifier(port)) for port, value in item.inputs)
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
            equations=self._following.law.derivative_equations,
            derivatives=dict(self._following.law.derivatives),
            changes=self._changes,
            method=self.law.method,
            printer=self._printer,
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
