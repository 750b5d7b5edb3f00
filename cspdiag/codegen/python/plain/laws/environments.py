"""Environments as Python modules: the plant and the operator as one system, and the devices."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cached_property
from typing import ClassVar

from cspdiag.base.record import record
from cspdiag.codegen.python.plain.docs import sentence
from cspdiag.codegen.python.plain.expressions import Printer
from cspdiag.codegen.python.plain.external import ExternalModules, external_call
from cspdiag.codegen.python.plain.laws.connections import Connections
from cspdiag.codegen.python.plain.laws.integration import Integration
from cspdiag.codegen.python.plain.laws.linear import STEP, LinearStep, MatrixEntry, linear_steps
from cspdiag.codegen.python.plain.laws.signal_names import MEMBERS, signal_names
from cspdiag.codegen.python.text.code import (
    COMPARISON,
    OR,
    PRODUCT,
    SUM,
    Code,
    Constant,
    Name,
    WholeNumber,
    call,
    counted_to,
    own,
)
from cspdiag.codegen.python.text.imports import Imports
from cspdiag.codegen.python.text.literals import docstring, quoted
from cspdiag.codegen.python.text.names import PackageNames
from cspdiag.codegen.python.text.operators import infix
from cspdiag.codegen.python.text.splitting import methods
from cspdiag.codegen.python.text.statements import For, Function, Statement, assign, if_, lines, run
from cspdiag.codegen.python.text.types import annotation, duration
from cspdiag.codegen.shared.laws.equations import (
    Equation,
    changes,
    constants_needed,
    defined,
    evaluated_in_stages,
    held,
    inputs,
    needed,
    outputs,
    signal_types,
    signals,
    uses_time,
    values,
)
from cspdiag.codegen.shared.names import words
from cspdiag.network.ir.declared import Declared
from cspdiag.network.ir.equations import ExternalCall, SubmodelEquation
from cspdiag.network.ir.network import Environment, Network, SubmodelClass, SubmodelState

ELAPSED = infix("-", SUM, Name("now"), own("now"))
"""The time from the previous instant to the present one."""

ADVANCE = "Integrate to `now` (in nanoseconds) with the inputs held, and evaluate the outputs."


@record
class EnvironmentModule:
    """The values for the template."""

    summary: str
    imports: list[str]
    constants: list[str]
    name: str
    docstring: list[str]
    attributes: list[str]
    functions: list[list[str]]


def environment_module(
    environment: Environment, network: Network, names: PackageNames, modules: ExternalModules
) -> EnvironmentModule:
    """The module of an environment."""
    return EnvironmentWriter(environment, network, names, modules).module()


class EnvironmentWriter:
    """Writes the module of one environment; the optimized target overrides its computations."""

    members: ClassVar[frozenset[str]] = MEMBERS
    """Names that the class and its methods use themselves."""

    def __init__(
        self, environment: Environment, network: Network, names: PackageNames, modules: ExternalModules
    ) -> None:
        self.environment = environment
        self.network = network
        self.package = names
        self.modules = modules
        self.system = environment.system
        self.tunable = words("parameters" if network.parameters else "")
        self.types = signal_types(self.system) if self.system is not None else {}
        self.names = signal_names(self.types, {*self.members, *self.tunable}, names)
        for device in environment.drivers:
            self.names[device.name]
        self.linear = [] if self.system is None else linear_steps(self.system, self.names)
        matrices = (name for step in self.linear for name in self._names_of_matrices(step))
        taken = {*(self.names[name] for name in self.types), *self.members, *self.tunable, *matrices}
        self.imports = Imports(names, taken=taken, dots="..")
        self.constants = constants_needed(self.system) if self.system is not None else []

    @cached_property
    def _in_stages(self) -> SubmodelClass | None:
        """The system without the states that move by a matrix."""
        return evaluated_in_stages(self.system) if self.system is not None else None

    def module(self) -> EnvironmentModule:
        """The values for the template."""
        environment = self.environment
        name = self.package.environments[environment.name]
        place = self.package.place(environment.span.file, environment.span.line)
        doc = sentence(environment.doc) if environment.doc else f"The environment {environment.name}."
        functions = [self._constructor(), self._start(), *self._advancing()]
        attributes = [
            assign("step", duration(environment.step, self.imports)),
            assign("on_miss", Constant(quoted(environment.on_miss))),
        ]
        constants = lines(self._constants(), "")
        bodies = methods(functions, self.imports)
        return EnvironmentModule(
            f"The environment {environment.name}.",
            self.imports.lines(),
            constants,
            name,
            docstring(f"{doc}\n\nSource: {place}", "    "),
            lines(attributes, "    "),
            bodies,
        )

    def _assigned(self, target: Code, printer: Printer, equation: SubmodelEquation) -> Iterable[Statement]:
        yield assign(target, printer.print(equation.value), self._place(equation))

    def _place(self, item: Declared) -> str:
        return self.package.place(item.span.file, item.span.line)

    def _names_of_matrices(self, step: LinearStep) -> Iterable[str]:
        return (step.a, step.m, step.n)

    def _printer(self, local: Iterable[str], time: Code | None = None) -> Printer:
        known = {*local, *(constant.name for constant in self.constants)}

        def signal(name: str) -> Code:
            return Name(self.names[name]) if name in known else own(self.names[name])

        return Printer(self.imports, signal=signal, time=time or Name("time"))

    def _constants(self) -> Iterable[Statement]:
        printer = self._printer(())
        for item in self.constants:
            yield assign(self.names[item.name], printer.print(item.value), self._place(item))
        for step in self.linear:
            yield from step.described()
            yield assign(step.a, step.coefficients(printer))

    def _calls(self) -> list[ExternalCall]:
        equations = self.system.equations if self.system is not None else ()
        return [equation for equation in equations if isinstance(equation, ExternalCall)]

    def _constructor(self) -> Function:
        statements: list[Statement] = [*self._at_time_0()]
        arguments = ["self"]
        if self.tunable:
            class_ = self.imports.parameters()
            arguments.append(f"parameters: {class_} | None = None")
            statements.append(assign(own("parameters"), infix("or", OR, Name("parameters"), call(class_))))
        connections = Connections(self.environment, self.network, self.names, self.modules, self.imports)
        statements += connections.devices()
        statements += connections.signals()
        printer = self._printer(())
        for item in self._calls():
            given = {name: printer.print(value) for name, value in item.arguments}
            outputs = [port for port, _, _ in item.outputs]
            made = self.modules.construct(item.external, given, self.imports, outputs)
            statements.append(assign(own(self.names[item.name]), made))
        statements.append(connections.drivers())
        return Function("__init__", tuple(arguments), tuple(statements))

    def _start(self) -> Function:
        statements: list[Statement] = [*self._at_time_0()]
        if self.system is not None:
            statements += self._initial(state for state in self.system.states if not self._is_local(state))
        statements += [
            run(own(self.names[item.name]).call("reset"))
            for item in self._calls()
            if self.modules.describe(item.external).has_reset
        ]
        statements += self._first_evaluation()
        return Function("start", ("self",), tuple(statements), doc="Go to time 0 and evaluate the outputs.")

    def _at_time_0(self) -> Iterable[Statement]:
        return (assign(own("now"), WholeNumber(0)),)

    def _is_local(self, state: SubmodelState) -> bool:
        """Whether a state is a local variable from one instant to the next."""
        return False

    def _initial(self, states: Iterable[SubmodelState]) -> Iterable[Statement]:
        """Gives states their initial values."""
        printer = self._printer((), Constant("0.0"))
        for state in states:
            name = self.names[state.name]
            yield assign(name if self._is_local(state) else own(name), printer.print(state.initial))

    def _first_evaluation(self) -> Iterable[Statement]:
        if self._result_equations():
            yield run(own("_evaluate").called())

    def _result_equations(self) -> list[Equation]:
        return needed(self.system.equations, outputs(self.system)) if self.system is not None else []

    def _advancing(self) -> list[Function]:
        """The method that advances, and those that it calls."""
        functions = [self._advance()]
        if self.system is not None and self._result_equations():
            functions.append(self._evaluate(self.system))
        if self._in_stages is not None and self._in_stages.derivatives:
            functions.append(self._derivatives(self._in_stages))
        return functions

    def _advance(self) -> Function:
        statements: list[Statement] = []
        system = self.system
        if system is not None and system.states:
            statements += self._moved(system)
        statements.append(assign(own("now"), Name("now")))
        if system is not None and self._result_equations():
            statements += self._evaluated(system)
        return Function("advance", ("self", "now: int"), tuple(statements), doc=ADVANCE)

    def _moved(self, system: SubmodelClass) -> Iterable[Statement]:
        """From the previous instant to ``now``: next values and slopes are computed from the inputs at the previous
        instant.
        """
        in_stages = evaluated_in_stages(system)
        integration = Integration(in_stages, self.names, self._place, self.imports)
        equations, wanted = self._wanted(system)
        given = [name for name in inputs(system) if name in wanted]
        continuous = [state.name for state in system.states if state.continuous]
        discrete = [state.name for state in system.states if not state.continuous and state.name in wanted]
        local = [*given, *continuous, *discrete, *(name for e in equations for name in defined(e))]
        local += [item.name for step in self.linear for item in step.block.equations]
        kept = [name for name in self._called() if name in wanted]
        local += kept
        printer = self._printer(local)
        timed = uses_time((equations, system.next_values)) or (in_stages.derivatives and integration.timed)
        if timed:
            yield assign("time", self._seconds(self._previous()))
        for name in given:
            yield assign(self.names[name], self._signal(name).field("value"))
        for name in (*discrete, *continuous, *kept):
            if name not in self._already_local(system):
                yield assign(self.names[name], own(self.names[name]))
        for equation in equations:
            if isinstance(equation, SubmodelEquation):
                yield from self._assigned(Name(self.names[equation.name]), printer, equation)
        if system.next_values:
            places = {name: self._place(state) for name, state in changes(system).items()}
            updates = tuple(
                assign(own(self.names[name]), printer.print(value), places[name]) for name, value in system.next_values
            )
            due = infix("==", COMPARISON, infix("%", PRODUCT, Name("now"), own("step")), WholeNumber(0))
            yield if_(due, *updates)
        for step in self.linear:
            for equation in step.block.equations:
                yield from self._assigned(Name(self.names[equation.name]), printer, equation)
        if system.derivatives:
            yield from self._integrated(system, integration, printer)

    def _wanted(self, system: SubmodelClass) -> tuple[list[Equation], set[str]]:
        """The equations from which next values and slopes follow, and all signals that are read for that."""
        roots = {*signals((system.next_values,)), *(held(system) if system.derivatives else ())}
        equations = needed(system.equations, roots, calls=False)
        read = signals((tuple(part for e in equations for part in values(e)), system.next_values))
        return equations, {*read, *roots}

    def _called(self) -> list[str]:
        """The signals that bodies in Python compute, once in each instant."""
        return [local for item in self._calls() for _, local, _ in item.outputs]

    def _integrated(self, system: SubmodelClass, integration: Integration, printer: Printer) -> Iterable[Statement]:
        """The steps of all continuous states; ``integration`` is for those that do not move by a matrix."""
        interval = self._seconds(ELAPSED)
        count: Code | None = None
        if system.step is None:
            yield assign("h", interval)
        else:
            step = duration(system.step, self.imports)
            ceil = self.imports.standard("math", "ceil")
            ratio = infix("/", PRODUCT, ELAPSED, step)
            count = Name("steps")
            yield assign("steps", call(ceil, ratio))
            yield assign("h", infix("/", PRODUCT, interval, count))
        if self.linear:
            yield STEP
        for linear in self.linear:
            yield linear.matrices(Name(linear.a), self.imports)
            moved = linear.moved(_entry_of(linear.m), _entry_of(linear.n), printer)
            yield moved if count is None else For("_", counted_to(count), (moved,))
        if integration.states:
            yield from integration.loop(count)
        for name, state in changes(system).items():
            if state.continuous:
                moved_state = self.names[name]
                value = call(self.imports.runtime("finite"), Name(moved_state))
                yield assign(own(moved_state), value, self._place(state))

    def _previous(self) -> Code:
        """The previous instant."""
        return own("now")

    def _signal(self, name: str) -> Code:
        """The signal of a port."""
        return own(self.names[name])

    def _already_local(self, system: SubmodelClass) -> Sequence[str]:
        """What is in a local variable when ``advance`` begins."""
        return ()

    def _seconds(self, nanoseconds: Code) -> Code:
        return infix("/", PRODUCT, nanoseconds, Name(self.imports.runtime("s")))

    def _evaluated(self, system: SubmodelClass) -> Iterable[Statement]:
        """At the end of ``advance``: evaluate the outputs."""
        return [run(own("_evaluate").called())]

    def _evaluate(self, system: SubmodelClass) -> Function:
        return Function("_evaluate", ("self",), tuple(self._evaluation(system, own("now"), ())))

    def _evaluation(self, system: SubmodelClass, now: Code, present: Iterable[str]) -> list[Statement]:
        """Evaluate the outputs at the instant ``now``; the states in ``present`` are already in local variables."""
        equations = self._result_equations()
        results = outputs(system)
        read = signals(tuple(part for equation in equations for part in values(equation)))
        given = [name for name in inputs(system) if read[name]]
        states = [state.name for state in system.states if read[state.name] > 1 and state.name not in present]
        local = [*given, *states, *present, *(name for equation in equations for name in defined(equation))]
        printer = self._printer(local)
        # `advance` needs them at the next instant.
        kept = self._wanted(system)[1] - {*self._already_local(system)} if system.states else ()
        statements: list[Statement] = []
        takes_time = any(self.modules.describe(item.external).takes_time for item in self._calls())
        if uses_time((tuple(part for equation in equations for part in values(equation)),)) or takes_time:
            statements.append(assign("time", self._seconds(now)))
        statements += [assign(self.names[name], self._signal(name).field("value")) for name in given]
        statements += [assign(self.names[name], own(self.names[name])) for name in states]
        for equation in equations:
            if isinstance(equation, ExternalCall):
                statements.extend(external_call(equation, self.names, printer, self.modules, time=Name("time")))
                statements += [
                    assign(own(self.names[local]), Name(self.names[local]))
                    for _, local, _ in equation.outputs
                    if local in kept
                ]
            else:
                name = self.names[equation.name]
                handed_over = equation.name in results and not read[equation.name]
                target = self._signal(equation.name).field("value") if handed_over else Name(name)
                statements += self._assigned(target, printer, equation)
        done = {
            equation.name
            for equation in equations
            if isinstance(equation, SubmodelEquation) and not read[equation.name]
        }
        statements += [
            assign(self._signal(name).field("value"), printer.signal(name)) for name in results if name not in done
        ]
        return statements

    def _derivatives(self, system: SubmodelClass) -> Function:
        """The method that the integration calls."""
        integration = Integration(system, self.names, self._place, self.imports)
        moving = [state.name for state in system.states if state.continuous]
        moving += [equation.name for equation in system.derivative_equations]
        printer = self._printer([*integration.held, *moving])
        annotations = {name: annotation(type_, self.imports) for name, type_ in self.types.items()}
        return integration.derivatives(printer, annotations)


def _entry_of(matrix: str) -> MatrixEntry:
    return lambda row, column: Name(matrix).at(row).at(column)
