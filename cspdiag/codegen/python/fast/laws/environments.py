"""Environments at ``-O1``: the plant as flat code, its states in local variables while they are integrated, its
constants as values.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property
from typing import ClassVar

from cspdiag.codegen.python.fast.expressions import NANOSECONDS, SCALAR, FastPrinter
from cspdiag.codegen.python.fast.laws.integration import InlineIntegration, SubStep
from cspdiag.codegen.python.fast.statements import assigned, refused_unless_finite
from cspdiag.codegen.python.fast.temporaries import Temporaries
from cspdiag.codegen.python.plain.environments import MEMBERS, EnvironmentModule, EnvironmentWriter
from cspdiag.codegen.python.plain.expressions import Printer
from cspdiag.codegen.python.plain.external import ExternalModules
from cspdiag.codegen.python.plain.integration import Integration
from cspdiag.codegen.python.text.code import PRODUCT, Atom, Code, call, infix
from cspdiag.codegen.python.text.names import PackageNames
from cspdiag.codegen.python.text.statements import Block, Line, Statement, assign, lines
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
        """Constants of which the value is known; those with a fault keep it for the running program."""
        known: dict[str, Value] = {}
        for item in self.constants:
            value = constant_value(item.value, lambda part: known.get(part.name))
            if value is not None:
                known[item.name] = value
        return known

    @cached_property
    def _temporaries(self) -> Temporaries:
        return Temporaries(self.names)

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

    def _assigned(self, target: str, printer: Printer, equation: SubmodelEquation) -> Iterable[Statement]:
        assert isinstance(printer, FastPrinter)
        return assigned(target, printer, equation.value, self._place(equation))

    def _seconds(self, nanoseconds: str) -> Code:
        return infix("/", PRODUCT, Atom(nanoseconds), NANOSECONDS)

    def _start_statements(self) -> Iterable[Statement]:
        if self.system is not None and self.system.derivatives:
            yield Line("self._elapsed = ", Atom("0"))

    def _integrated(self, system: SubmodelClass, integration: Integration) -> Iterable[Statement]:
        printer = self._printer([*integration.held, *(state.name for state in system.states if state.continuous)])
        inline = InlineIntegration(
            states=[state.name for state in system.states if state.continuous],
            equations=system.derivative_equations,
            derivatives=dict(system.derivatives),
            method=system.method,
            printer=printer,
            local=self.names.__getitem__,
            names=self.names,
            place=self._place,
            step=SubStep(Atom("h"), Atom("half"), Atom("sixth")),
        )
        yield assign("elapsed", Atom("now - self.now"))
        yield Block(Line("if elapsed != self._elapsed:"), (Line("self._divide(elapsed)"),))
        for name in ("h",) if system.method == "euler" else ("h", "half", "sixth"):
            yield assign(name, Atom(f"self._{name}"))
        within = inline.statements()
        if system.step is None:
            yield from (assign("t", Atom("time")),) if inline.timed else ()
            yield from within
        else:
            counter = "step" if inline.timed else "_"
            clock = (assign("t", Atom("time + step * h")),) if inline.timed else ()
            yield Block(Line(f"for {counter} in self._steps:"), (*clock, *within))
        for state in integration.states:
            yield refused_unless_finite(state, self.imports)
            yield assign(f"self.{state}", Atom(state))

    def _evaluated(self, system: SubmodelClass) -> Iterable[Statement]:
        present = [state.name for state in system.states if state.continuous] if system.derivatives else []
        return self._evaluation(system, "now", present)

    def _derivatives(self, system: SubmodelClass) -> list[list[str]]:
        """Further methods: how long a sub-step is depends on the time between instants, which seldom changes."""
        statements = [assign("self._elapsed", Atom("elapsed"))]
        interval = self._seconds("elapsed")
        if system.step is None:
            doc = "Remember the time between two instants, over which states are integrated in one step."
            statements.append(assign("self._h", interval))
        else:
            doc = "Divide the time between two instants into equal steps."
            count = infix("/", PRODUCT, Atom("elapsed"), Atom(f"{system.step:_}"))
            ceil = self.imports.standard("math", "ceil")
            statements.append(assign("self._steps", call("range", call(ceil, count))))
            statements.append(assign("self._h", infix("/", PRODUCT, interval, Atom("len(self._steps)"))))
        if system.method == "rk4":
            statements.append(assign("self._half", Atom("self._h / 2")))
            statements.append(assign("self._sixth", Atom("self._h / 6")))
        return [
            ["    def _divide(self, elapsed: int) -> None:", f'        """{doc}"""', *lines(statements, "        ")]
        ]
