"""Environments at ``-O1``: the plant as flat code, with states in local variables during integration and constants as
values.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property
from typing import ClassVar

from cspdiag.codegen.python.fast.expressions import NANOSECONDS, SCALAR, FastPrinter
from cspdiag.codegen.python.fast.laws.integration import InlineIntegration, SubStep
from cspdiag.codegen.python.fast.statements import assigned, refused_unless_finite
from cspdiag.codegen.python.fast.temporaries import Temporaries
from cspdiag.codegen.python.plain.environments import ELAPSED, MEMBERS, EnvironmentModule, EnvironmentWriter
from cspdiag.codegen.python.plain.expressions import Printer
from cspdiag.codegen.python.plain.external import ExternalModules
from cspdiag.codegen.python.plain.integration import Integration, begin_of_step
from cspdiag.codegen.python.text.code import (
    COMPARISON,
    PRODUCT,
    Code,
    Constant,
    Name,
    WholeNumber,
    call,
    counted_to,
    infix,
    own,
)
from cspdiag.codegen.python.text.names import PackageNames
from cspdiag.codegen.python.text.statements import For, Function, Statement, assign, if_, run
from cspdiag.codegen.shared.equations import changes
from cspdiag.network.elaborate.constant_value import constant_value
from cspdiag.network.ir.equations import SubmodelEquation
from cspdiag.network.ir.expressions import Value
from cspdiag.network.ir.network import Environment, Network, SubmodelClass


def environment_module(
    environment: Environment, network: Network, names: PackageNames, modules: ExternalModules
) -> EnvironmentModule:
    """The module of an environment."""
    return _FastEnvironmentWriter(environment, network, names, modules).module()


class _FastEnvironmentWriter(EnvironmentWriter):
    members: ClassVar[frozenset[str]] = MEMBERS | {"elapsed", "_elapsed", "_half", "_sixth", "_divide", "_part"}

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

    def _printer(self, local: Iterable[str], time: Code | None = None) -> FastPrinter:
        plain = super()._printer(local, time)
        temporaries = Temporaries(self.names)
        return FastPrinter(
            plain.imports, signal=plain.signal, time=plain.time, known=self._known, temporaries=temporaries
        )

    def _assigned(self, target: Code, printer: Printer, equation: SubmodelEquation) -> Iterable[Statement]:
        assert isinstance(printer, FastPrinter)
        return assigned(target, printer, equation.value, self._place(equation))

    def _seconds(self, nanoseconds: Code) -> Code:
        return infix("/", PRODUCT, nanoseconds, NANOSECONDS)

    def _start_statements(self) -> Iterable[Statement]:
        if self.system is not None and self.system.derivatives:
            yield assign(own("_elapsed"), WholeNumber(0))

    def _integrated(self, system: SubmodelClass, integration: Integration) -> Iterable[Statement]:
        printer = self._printer([*integration.held, *(state.name for state in system.states if state.continuous)])
        inline = InlineIntegration(
            states=[state.name for state in system.states if state.continuous],
            equations=system.derivative_equations,
            derivatives=dict(system.derivatives),
            changes=changes(system),
            method=system.method,
            printer=printer,
            local=self.names.__getitem__,
            names=self.names,
            place=self._place,
            step=SubStep(Name("h"), Name("half"), Name("sixth")),
        )
        elapsed = Name("elapsed")
        yield assign(elapsed, ELAPSED)
        yield if_(infix("!=", COMPARISON, elapsed, own("_elapsed")), run(own("_divide").called(elapsed)))
        for name in ("h",) if system.method == "euler" else ("h", "half", "sixth"):
            yield assign(name, own(f"_{name}"))
        within = inline.statements()
        if system.step is None:
            yield from (assign("t", Name("time")),) if inline.timed else ()
            yield from within
        else:
            counter = "step" if inline.timed else "_"
            clock = (assign("t", begin_of_step()),) if inline.timed else ()
            yield For(counter, own("_steps"), (*clock, *within))
        for name, state in changes(system).items():
            if state.continuous:
                moved = self.names[name]
                yield refused_unless_finite(Name(moved), self.imports, self._place(state))
                yield assign(own(moved), Name(moved))

    def _evaluated(self, system: SubmodelClass) -> Iterable[Statement]:
        present = [state.name for state in system.states if state.continuous] if system.derivatives else []
        return self._evaluation(system, Name("now"), present)

    def _derivatives(self, system: SubmodelClass) -> list[Function]:
        """Additional methods: the length of a sub-step depends on the time between instants, which rarely changes."""
        elapsed = Name("elapsed")
        statements = [assign(own("_elapsed"), elapsed)]
        interval = self._seconds(elapsed)
        if system.step is None:
            doc = "Remember the time between two instants, over which states are integrated in one step."
            statements.append(assign(own("_h"), interval))
        else:
            doc = "Divide the time between two instants into equal steps."
            count = infix("/", PRODUCT, elapsed, Constant(f"{system.step:_}"))
            ceil = self.imports.standard("math", "ceil")
            statements.append(assign(own("_steps"), counted_to(call(ceil, count))))
            statements.append(assign(own("_h"), infix("/", PRODUCT, interval, call("len", own("_steps")))))
        if system.method == "rk4":
            statements.append(assign(own("_half"), infix("/", PRODUCT, own("_h"), WholeNumber(2))))
            statements.append(assign(own("_sixth"), infix("/", PRODUCT, own("_h"), WholeNumber(6))))
        return [Function("_divide", ("self", "elapsed: int"), tuple(statements), doc=doc)]
