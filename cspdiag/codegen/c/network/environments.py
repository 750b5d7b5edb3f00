"""Environments as C files: plant and operator as one system, compiled with the program into a native closed loop."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cached_property

from cspdiag.base.record import record
from cspdiag.codegen.c.laws.calls import body_name
from cspdiag.codegen.c.laws.equations import (
    EquationWriter,
    LocalVariable,
    Target,
    check_finite_together,
    end_if_faulted,
    record_fault_place,
)
from cspdiag.codegen.c.laws.integration import Integration, steps_until_now
from cspdiag.codegen.c.laws.linear import LinearStep, linear_steps
from cspdiag.codegen.c.network.devices import Devices
from cspdiag.codegen.c.network.literals import WithLiterals, with_literals
from cspdiag.codegen.c.network.parameters import parameter_of
from cspdiag.codegen.c.network.signals import Signals
from cspdiag.codegen.c.text.code import (
    CSP,
    EQUALITY,
    PRODUCT,
    Aggregate,
    Code,
    address,
    call,
    code,
    ignored,
    infix,
    negated,
    own,
)
from cspdiag.codegen.c.text.documents import comment, wrapped
from cspdiag.codegen.c.text.expressions import Printer
from cspdiag.codegen.c.text.kernel import KERNEL
from cspdiag.codegen.c.text.names import ENVIRONMENT_LOCALS, Names, PackageNames
from cspdiag.codegen.c.text.statements import (
    Blank,
    Block,
    Function,
    Remark,
    Statement,
    choose,
    define,
    lines,
    return_value,
    run,
    store,
    with_kernel,
)
from cspdiag.codegen.c.text.types import CTypes, duration
from cspdiag.codegen.shared.laws.equations import (
    Equation,
    changes,
    constants_needed,
    defined,
    evaluated_in_stages,
    held,
    needed,
    outputs,
    read_after_change,
    signal_types,
    signals,
    uses_time,
    values,
)
from cspdiag.model.types import Type
from cspdiag.network.ir.declared import Declared
from cspdiag.network.ir.equations import ExternalCall
from cspdiag.network.ir.expressions import TunableValue
from cspdiag.network.ir.network import Environment, ExternalPort, Network, SubmodelClass, SubmodelState
from cspdiag.network.ir.walk import parts

_STATE = "void *state"
"""The parameter of the functions in the table, which know nothing of the struct."""


@record
class EnvironmentFiles:
    """Writes the files of one environment. Its signals are members of a struct of its name."""

    environment: Environment
    network: Network
    names: PackageNames
    types: CTypes

    @cached_property
    def name(self) -> str:
        """The name of the files, and the prefix of what they define."""
        return self.names.environments[self.environment.name]

    @cached_property
    def _with_literals(self) -> WithLiterals | None:
        return None if self.environment.system is None else with_literals(self.environment.system)

    @cached_property
    def _system(self) -> SubmodelClass | None:
        return None if self._with_literals is None else self._with_literals.system

    @cached_property
    def _signal_types(self) -> dict[str, Type]:
        return signal_types(self._system) if self._system is not None else {}

    @cached_property
    def _members(self) -> Names:
        members = Names({*self.names.globals, *ENVIRONMENT_LOCALS})
        for port in self.network.external_ports:
            members[port.key]
        return members

    @cached_property
    def _devices(self) -> Devices:
        return Devices(self.environment, self.network, self.names, self.types, self._members)

    @cached_property
    def _ports(self) -> Signals:
        return Signals(self.name, self.network, self.types, self._members, self._devices)

    @cached_property
    def _literals(self) -> dict[str, str]:
        """The C names of the constants that C compilers know."""
        return (
            {} if self._with_literals is None else {name: self._members[name] for name in self._with_literals.literals}
        )

    @cached_property
    def _calls(self) -> list[ExternalCall]:
        equations = self._system.equations if self._system is not None else ()
        return [equation for equation in equations if isinstance(equation, ExternalCall)]

    @cached_property
    def _results(self) -> list[Equation]:
        return needed(self._system.equations, outputs(self._system)) if self._system is not None else []

    def _place(self, item: Declared) -> str:
        return self.names.place(item.span.file, item.span.line)

    def member(self, port: ExternalPort) -> str:
        """The member of the struct that has the present value of a port of the program."""
        name = self._members[port.key]
        return f"{name}[0]" if port.medium == "event" else name

    @property
    def state_members(self) -> list[tuple[SubmodelState, str]]:
        """The states of the environment, with their members of the struct."""
        states = () if self._system is None else self._system.states
        return [(state, self._members[state.name]) for state in states]

    def files(self) -> dict[str, str]:
        """The header and the source."""
        return {f"{self.name}.h": self._header(), f"{self.name}.c": self._source()}

    def _header(self) -> str:
        environment, guard = self.environment, f"{self.name.upper()}_H"
        about = [*wrapped(environment.doc or f"The environment {environment.name}."), ""]
        about.append(f"Source: {self._place(environment)}")
        rows = [*comment(about), f"#ifndef {guard}", f"#define {guard}", ""]
        rows += ['#include "csp_linear.h"'] if self._linear else []
        rows += ['#include "network.h"']
        rows += sorted({f'#include "{body_name(call)}.h"' for call in self._calls})
        rows += self._devices.headers()
        rows += ["", "/* The state of the plant and the operator, with their signals. */", *lines([self._struct()])]
        rows += ["", "/* One of them, and what it is behind the ports of the program. */"]
        rows += [f"extern const csp_environment {self.name};"]
        rows += [f"extern const struct network_drivers {self.name}_drivers;", "", "#endif", ""]
        return "\n".join(rows)

    def _source(self) -> str:
        rows = [f"/* See {self.name}.h. */", f'#include "{self.name}.h"', ""]
        rows += ['#include "csp_arithmetic.h"', '#include "types.h"', '#include "constants.h"']
        checks = self._devices.checks()
        rows += ['#include "csp_by_hand.h"', "", *checks] if checks else []
        parts: list[Statement] = [define(f"static struct {self.name}", "present"), *self._ports.transfers()]
        parts += self._devices.transfers()
        if self._in_stages is not None and self._in_stages.derivatives:
            writer = self._writer(self._slopes_printer, at=True)
            parts += self._integration.function(self._slopes_printer, writer)
        parts += [self._evaluate()] if self._results else []
        parts += [self._start(), self._advance(), *self._devices.closing(f"{self.name}_close", self.name)]
        parts += [self._ports.drivers(), self._table()]
        if self._with_literals is not None:
            literals = self._with_literals.definitions(parts, self._literals, self.types)
            rows += ["", *lines(literals)] if literals else []
        for part in parts:
            rows += ["", *lines([part])] if not isinstance(part, Blank) else []
        return "\n".join([*rows, ""])

    # ---- The state

    def _struct(self) -> Statement:
        statements: list[Statement] = [define("int64_t", "now", remark="in nanoseconds")]
        if self.uses_parameters:
            statements.append(define("const struct network *", "program", remark="which has the parameters"))
        system = self._system
        statements += self._ports.fields()
        if system is not None:
            local = {name for call in self._calls for _, name, _ in call.outputs}
            stored = [(state.name, state.type) for state in system.states]
            stored += [(item.name, item.type) for item in constants_needed(system)]
            stored += [(name, self._signal_types[name]) for name in sorted(local)]
            statements += [define(self.types.type_name(type_), self._members[name]) for name, type_ in stored]
            statements += [define(f"struct {body_name(item)}", self._members[item.name]) for item in self._calls]
            statements += [step.declaration() for step in self._linear]
        statements += self._devices.fields()
        return Block(tuple(statements), f"struct {self.name}", "};")

    def _signal(self, name: str) -> Code:
        """The lvalue of a port, a state or a constant."""
        ports = {port.key: port for port in self.network.external_ports}
        place = own(self._members[name])
        return place.at(0) if name in ports and ports[name].medium == "event" else place

    def _printer(self, local: Iterable[str], time: str = "time") -> Printer:
        known = set(local)

        def lvalue(name: str) -> Code:
            return code(self._members[name]) if name in known else self._signal(name)

        def program(name: str) -> Code:
            return address(parameter_of(own("program"), name, self.network, self.names))

        return Printer(self.types, signal=lvalue, time=time, program=program, constants=self._literals)

    @cached_property
    def uses_parameters(self) -> bool:
        """Whether the environment uses parameters of the program."""
        return any(isinstance(part, TunableValue) for part in parts(self._system))

    def _writer(self, printer: Printer, *, at: bool = False) -> EquationWriter:
        """``at``: for a function that does not return whether it failed; its caller checks."""
        check = record_fault_place if at else end_if_faulted
        return EquationWriter(printer, self._place, check, lambda name: own(self._members[name]), body_name)

    # ---- What happens

    @cached_property
    def _integration(self) -> Integration:
        system = self._in_stages
        assert system is not None
        return Integration(
            name=f"{self.name}_slopes",
            owner=self.name,
            local=lambda name: self._members[name],
            types=self._signal_types,
            states=tuple(state.name for state in system.states if state.continuous),
            held=tuple(held(system)),
            equations=system.derivative_equations,
            derivatives=system.derivatives,
            changes=changes(system),
            method=system.method,
        )

    @cached_property
    def _slopes_printer(self) -> Printer:
        integration = self._integration
        inner = [*integration.states, *integration.held, *(equation.name for equation in integration.equations)]
        return self._printer(inner)

    @cached_property
    def _in_stages(self) -> SubmodelClass | None:
        """The system without the states that move by a matrix."""
        return None if self._system is None else evaluated_in_stages(self._system)

    @cached_property
    def _linear(self) -> list[LinearStep]:
        return [] if self._system is None else linear_steps(self._system, self._members)

    def _start(self) -> Function:
        statements: list[Statement] = [self._self(), *self._program(), store(own("now"), "0"), *self._devices.opening()]
        system = self._system
        if system is not None:
            printer = self._printer((), "0.0")
            writer = self._writer(printer, at=True)
            for constant in constants_needed(system):
                statements += writer.assign(self._signal(constant.name), constant.value, self._place(constant))
            for item in self._calls:
                setup, arguments = printer.arguments([value for _, value in item.arguments])
                statements += setup
                body = address(own(self._members[item.name]))
                statements.append(run(call(f"{body_name(item)}_initialize", body, *arguments)))
            for state in system.states:
                statements += writer.assign(self._signal(state.name), state.initial, self._place(state))
            for step in self._linear:
                statements += step.start(printer)
        if self._results:
            statements.append(run(ignored(call(f"{self.name}_evaluate", CSP, "self"))))
        statements += self._ports.starting()
        statements.append(return_value(negated(call("csp_faulted"))))
        return Function(f"static bool {self.name}_start", (KERNEL, _STATE), tuple(statements))

    def _advance(self) -> Function:
        system = self._system
        statements: list[Statement] = [self._self(), *self._program()]
        statements += self._state_updates(system) if system is not None and system.states else []
        statements.append(store(own("now"), "now"))
        statements.append(return_value(call(f"{self.name}_evaluate", CSP, "self") if self._results else "true"))
        return Function(f"static bool {self.name}_advance", (KERNEL, _STATE, "int64_t now"), with_kernel(statements))

    def _self(self) -> Statement:
        return define(f"struct {self.name} *const", "self", "state")

    def _program(self) -> list[Statement]:
        """Where the parameters are: the program may have been moved since the last instant."""
        if not self.uses_parameters:
            return []
        return [store(own("program"), call("CSP_ENCLOSING", CSP, "struct network", "kernel"))]

    def _state_updates(self, system: SubmodelClass) -> list[Statement]:
        """The statements that advance the states to ``now``, with the present values of the inputs."""
        integrates = bool(system.derivatives)
        roots = {*signals((system.next_values,)), *(held(system) if integrates else ())}
        equations = needed(system.equations, roots, calls=False)
        continuous = [state.name for state in system.states if state.continuous] if integrates else []
        discrete = self._read_late(system)
        local = [*continuous, *discrete, *(name for equation in equations for name in defined(equation))]
        local += [item.name for block in system.linear for item in block.equations]
        printer = self._printer(local)
        writer = self._writer(printer)
        statements: list[Statement] = []
        if uses_time((equations, system.next_values)) or self._integration.depends_on_time:
            statements.append(define("const double", "time", call("csp_seconds", own("now"))))
        for name in (*discrete, *continuous):
            variable = self._variable(name, fixed=name not in continuous)
            statements.append(define(variable.type_name, variable.name, self._signal(name)))
        statements += writer.equations(equations, self._variable)
        places = {name: self._place(state) for name, state in changes(system).items()}
        if system.next_values:
            phase = infix("%", PRODUCT, code("now"), duration(self.environment.step))
            updates: list[Statement] = []
            for name, value in system.next_values:
                updates += writer.assign(self._signal(name), value, places[name])
            statements += choose(infix("==", EQUALITY, phase, code("0")), updates)
        for block in system.linear:
            statements += writer.equations(block.equations, self._variable)
        if integrates:
            statements += self._integration_statements(system, printer, places)
        return statements

    def _read_late(self, system: SubmodelClass) -> list[str]:
        """Discrete states that are read after they may have changed."""
        late = set(read_after_change(system.next_values))
        if system.derivatives:
            late |= set(held(system)) & {name for name, _ in system.next_values}
        return [state.name for state in system.states if state.name in late and not state.continuous]

    def _variable(self, name: str, *, fixed: bool = True) -> LocalVariable:
        type_name = self.types.type_name(self._signal_types[name])
        return LocalVariable(f"const {type_name}" if fixed else type_name, self._members[name])

    def _integration_statements(
        self, system: SubmodelClass, printer: Printer, places: Mapping[str, str]
    ) -> list[Statement]:
        statements, count = steps_until_now(system.step)
        if self._linear:
            statements.append(Remark("A step of RK4 over h is x = M x + N r."))
        for linear in self._linear:
            statements += linear.moved(printer, count)
        if self._integration.states:
            statements += self._integration.steps(printer.signal, count)
        states = tuple(state.name for state in system.states if state.continuous)
        tested = [(code(self._members[state]), places[state]) for state in states]
        statements += check_finite_together(
            tested, self._writer(printer).check, may_have_faulted=self._integration.can_fault
        )
        statements += [store(self._signal(state), code(self._members[state])) for state in states]
        return statements

    def _evaluate(self) -> Function:
        assert self._system is not None
        equations = self._results
        results = outputs(self._system)
        stored = {*results, *(name for call in self._calls for _, name, _ in call.outputs)}
        local = [name for equation in equations for name in defined(equation) if name not in stored]
        writer = self._writer(self._printer(local))

        def target(name: str) -> Target:
            return self._signal(name) if name in stored else self._variable(name)

        statements: list[Statement] = []
        if uses_time((tuple(part for equation in equations for part in values(equation)),)):
            statements.append(define("const double", "time", call("csp_seconds", own("now"))))
        statements += [*writer.equations(equations, target), return_value("true")]
        return Function(
            f"static bool {self.name}_evaluate", (KERNEL, f"struct {self.name} *self"), with_kernel(statements)
        )

    def _table(self) -> Statement:
        functions = (code(f"{self.name}_start"), code(f"{self.name}_advance"))
        close = code(f"{self.name}_close" if self.environment.drivers else "NULL")
        all_parts = (duration(self.environment.step), *functions, address(code("present")), close)
        parts = tuple((None, part) for part in all_parts)
        return define("const csp_environment", self.name, Aggregate(parts))


def environment_files(environment: Environment, network: Network, names: PackageNames, types: CTypes) -> dict[str, str]:
    """The header and the source of an environment."""
    return EnvironmentFiles(environment, network, names, types).files()
