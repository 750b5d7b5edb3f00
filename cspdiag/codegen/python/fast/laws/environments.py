"""Environments at ``-O1``: the plant as flat code, with states in local variables during integration and constants as
values.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property
from typing import ClassVar

from cspdiag.codegen.python.fast.expressions import NANOSECONDS, SCALAR, FastPrinter
from cspdiag.codegen.python.fast.laws.integration import InlineIntegration, SubStep
from cspdiag.codegen.python.fast.statements import assigned, is_test, refused_unless_all_finite, refused_unless_finite
from cspdiag.codegen.python.fast.temporaries import Temporaries
from cspdiag.codegen.python.plain.expressions import Printer
from cspdiag.codegen.python.plain.external import ExternalModules
from cspdiag.codegen.python.plain.laws.environments import ADVANCE, EnvironmentModule, EnvironmentWriter
from cspdiag.codegen.python.plain.laws.integration import Integration, begin_of_step
from cspdiag.codegen.python.plain.laws.linear import STEP, LinearStep, MatrixEntry
from cspdiag.codegen.python.plain.laws.signal_names import MEMBERS
from cspdiag.codegen.python.text.code import (
    COMPARISON,
    PRODUCT,
    SUM,
    TRUE,
    Code,
    Constant,
    Name,
    WholeNumber,
    call,
    counted_to,
    mentions,
    own,
)
from cspdiag.codegen.python.text.names import PackageNames
from cspdiag.codegen.python.text.operators import infix
from cspdiag.codegen.python.text.statements import Block, For, Function, Statement, assign, if_, run
from cspdiag.codegen.shared.laws.equations import changes, held
from cspdiag.network.elaborate.constant_value import constant_value
from cspdiag.network.ir.equations import SubmodelEquation
from cspdiag.network.ir.expressions import Value
from cspdiag.network.ir.network import Environment, Network, SubmodelClass, SubmodelState

YIELDED = Constant("yield")
"""What a generator is resumed with."""


def environment_module(
    environment: Environment, network: Network, names: PackageNames, modules: ExternalModules
) -> EnvironmentModule:
    """The module of an environment."""
    return _FastEnvironmentWriter(environment, network, names, modules).module()


class _FastEnvironmentWriter(EnvironmentWriter):
    """Continuous states are local variables of a generator, ``_running``, which ``advance`` resumes.

    It evaluates the outputs and waits for the next instant, to which it then integrates.
    """

    members: ClassVar[frozenset[str]] = MEMBERS | {"before", "elapsed", "_run", "_running"}

    _runs = False
    """Whether ``_running`` is being written."""

    @cached_property
    def _known(self) -> dict[str, Value]:
        """Constants with a known value; one that faults is computed in the running program."""
        known: dict[str, Value] = {}
        for item in self.constants:
            value = constant_value(item.value, lambda part: known.get(part.name))
            if value is not None:
                known[item.name] = value
        return known

    def _constants(self) -> Iterable[Statement]:
        printer = self._printer(())
        for item in self.constants:
            if item.name not in self._known or not isinstance(item.type, SCALAR):
                yield assign(self.names[item.name], printer.print(item.value), self._place(item))
        for step in self.linear:
            yield from step.described()
            yield assign(step.a, step.coefficients(printer))

    def _printer(self, local: Iterable[str], time: Code | None = None) -> FastPrinter:
        plain = super()._printer(local, time)
        temporaries = Temporaries(self.names)
        return FastPrinter(
            plain.imports, signal=plain.signal, time=plain.time, known=self._known, temporaries=temporaries
        )

    def _assigned(self, target: Code, printer: Printer, equation: SubmodelEquation) -> Iterable[Statement]:
        assert isinstance(printer, FastPrinter)
        place = self._place(equation)
        if not is_test(equation.value):
            yield from assigned(target, printer, equation.value, place)
            return
        local = Name(self.names[equation.name])
        yield from assigned(local, printer, equation.value.arguments[0], place)
        yield refused_unless_finite(local, place, self.imports)
        if target != local:
            yield assign(target, local)

    def _seconds(self, nanoseconds: Code) -> Code:
        return infix("/", PRODUCT, nanoseconds, NANOSECONDS)

    @property
    def _is_continuous(self) -> bool:
        return self.system is not None and bool(self.system.derivatives)

    def _at_time_0(self) -> Iterable[Statement]:
        return () if self._is_continuous else super()._at_time_0()

    def _is_local(self, state: SubmodelState) -> bool:
        return state.continuous

    def _first_evaluation(self) -> Iterable[Statement]:
        if not self._is_continuous:
            yield from super()._first_evaluation()
            return
        yield assign(own("_run"), own("_running").called())
        yield run(call("next", own("_run")))

    def _advancing(self) -> list[Function]:
        if self.system is None or not self.system.derivatives:
            return super()._advancing()
        resumed = run(own("_run").call("send", Name("now")))
        return [
            Function("advance", ("self", "now: int"), (resumed,), doc=ADVANCE),
            self._running(self.system),
        ]

    def _running(self, system: SubmodelClass) -> Function:
        self._runs = True
        in_turn = (
            *self._evaluation(system, Name("now"), self._already_local(system)),
            assign("before", Name("now")),
            assign("now", YIELDED),
            *self._moved(system),
        )
        signals = [
            assign(self._signals[port.name], own(self.names[port.name]))
            for port in system.ports
            if mentions(in_turn, self._signals[port.name])
        ]
        initial = self._initial(state for state in system.states if state.continuous)
        generator = self.imports.standard("collections.abc", "Generator")
        return Function(
            "_running",
            ("self",),
            (
                *signals,
                *initial,
                assign("now", WholeNumber(0)),
                assign("elapsed", WholeNumber(0)),
                Block("while", TRUE, in_turn),
            ),
            f"{generator}[None, int, None]",
            doc="Evaluate the outputs, wait for the next instant, integrate to it, and again.",
        )

    @cached_property
    def _signals(self) -> dict[str, str]:
        """Local variables for the signals of ports."""
        ports = self.system.ports if self.system is not None else ()
        return {port.name: self.names.fresh(f"{self.names[port.name]}_signal") for port in ports}

    def _signal(self, name: str) -> Code:
        return Name(self._signals[name]) if self._runs else super()._signal(name)

    def _previous(self) -> Code:
        return Name("before") if self._runs else super()._previous()

    def _already_local(self, system: SubmodelClass) -> list[str]:
        if not self._runs:
            return []
        states = [state.name for state in system.states if state.continuous]
        return states + self._called()

    def _integrated(self, system: SubmodelClass, integration: Integration, printer: Printer) -> Iterable[Statement]:
        elapsed = infix("-", SUM, Name("now"), Name("before"))
        yield if_(infix("!=", COMPARISON, elapsed, Name("elapsed")), *self._divided(system, elapsed))
        if self.linear:
            yield STEP
            moved = tuple(step.moved(self._entries(step.m), self._entries(step.n), printer) for step in self.linear)
            yield from moved if system.step is None else (For("_", Name("steps"), moved),)
        if integration.states:
            yield from self._in_sub_steps(integration.class_)
        tested = [
            (Name(self.names[name]), self._place(state)) for name, state in changes(system).items() if state.continuous
        ]
        yield from refused_unless_all_finite(tested, self.imports)

    def _in_sub_steps(self, system: SubmodelClass) -> Iterable[Statement]:
        """The steps of states that are integrated by evaluating their derivatives."""
        states = [state.name for state in system.states if state.continuous]
        inline = InlineIntegration(
            states=states,
            equations=system.derivative_equations,
            derivatives=dict(system.derivatives),
            changes=changes(system),
            method=system.method,
            printer=self._printer([*held(system), *states]),
            local=self.names.__getitem__,
            names=self.names,
            place=self._place,
            step=SubStep(Name("h"), Name("half"), Name("sixth")),
        )
        within = inline.statements()
        if system.step is None:
            yield from (assign("t", Name("time")),) if inline.timed else ()
            yield from within
        else:
            counter = "step" if inline.timed else "_"
            clock = (assign("t", begin_of_step()),) if inline.timed else ()
            yield For(counter, Name("steps"), (*clock, *within))

    def _names_of_matrices(self, step: LinearStep) -> Iterable[str]:
        yield from super()._names_of_matrices(step)
        for i, row in enumerate(step.block.rows):
            yield from (self._entry(step.m, i, j) for j in row.of)
            yield from (self._entry(step.n, i, j) for j in row.held)

    def _entries(self, matrix: str) -> MatrixEntry:
        """The entries of a matrix as local variables."""
        return lambda row, column: Name(self._entry(matrix, row, column))

    def _entry(self, matrix: str, row: int, column: int) -> str:
        return self.names[f"{matrix}{row}{column}"]

    def _divided(self, system: SubmodelClass, elapsed: Code) -> Iterable[Statement]:
        """The length of a sub-step, which depends on the time between instants; that rarely changes."""
        yield assign("elapsed", elapsed)
        interval = self._seconds(Name("elapsed"))
        if system.step is None:
            yield assign("h", interval)
        else:
            count = infix("/", PRODUCT, Name("elapsed"), Constant(f"{system.step:_}"))
            ceil = self.imports.standard("math", "ceil")
            yield assign("steps", counted_to(call(ceil, count)))
            yield assign("h", infix("/", PRODUCT, interval, call("len", Name("steps"))))
        if system.method == "rk4" and self._in_stages is not None and self._in_stages.derivatives:
            yield assign("half", infix("/", PRODUCT, Name("h"), WholeNumber(2)))
            yield assign("sixth", infix("/", PRODUCT, Name("h"), WholeNumber(6)))
        for step in self.linear:
            yield step.matrices(Name(step.a), self.imports)
            for i, row in enumerate(step.block.rows):
                for j in row.of:
                    if not (row.keeps and i == j):
                        yield assign(self._entries(step.m)(i, j), Name(step.m).at(i).at(j))
                for j in row.held:
                    yield assign(self._entries(step.n)(i, j), Name(step.n).at(i).at(j))

    def _evaluated(self, system: SubmodelClass) -> Iterable[Statement]:
        return self._evaluation(system, Name("now"), ())
