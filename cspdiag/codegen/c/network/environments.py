"""Environments as C files: the plant and the operator as one system, compiled in, so that the closed loop is native."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cached_property

from cspdiag.base.record import record
from cspdiag.codegen.c.laws.equations import EquationWriter
from cspdiag.codegen.c.laws.integration import LOCALS, Integration
from cspdiag.codegen.c.laws.laws import body_name
from cspdiag.codegen.c.text.code import INDENT, statement
from cspdiag.codegen.c.text.documents import comment, wrapped
from cspdiag.codegen.c.text.expressions import Printer
from cspdiag.codegen.c.text.literals import quoted
from cspdiag.codegen.c.text.names import Names, PackageNames
from cspdiag.codegen.c.text.types import CTypes, duration
from cspdiag.codegen.shared.equations import (
    Equation,
    constants_needed,
    defined,
    held,
    needed,
    outputs,
    signal_types,
    signals,
    uses_time,
    values,
)
from cspdiag.model.types import ArrayType, StructType, Type
from cspdiag.network.ir.declared import Declared
from cspdiag.network.ir.equations import ExternalCall
from cspdiag.network.ir.network import Environment, ExternalPort, Network, SubmodelClass

_LOCALS = LOCALS | {"now", "present", "plant", "device", "value", "last"}


@record
class EnvironmentFiles:
    """Writes the files of one environment. Its signals are members of a static struct ``plant``."""

    environment: Environment
    network: Network
    names: PackageNames
    types: CTypes

    @cached_property
    def name(self) -> str:
        """Files, and what they offer, are called after it."""
        return self.names.environments[self.environment.name]

    @cached_property
    def _system(self) -> SubmodelClass | None:
        return self.environment.system

    @cached_property
    def _kinds(self) -> dict[str, Type]:
        return signal_types(self._system) if self._system is not None else {}

    @cached_property
    def _members(self) -> Names:
        members = Names({*self.names.globals, *_LOCALS})
        for port in self.network.external_ports:
            members[port_key(port)]
        return members

    @cached_property
    def _constants(self) -> list[str]:
        return [item.name for item in constants_needed(self._system)] if self._system is not None else []

    @cached_property
    def _calls(self) -> list[ExternalCall]:
        equations = self._system.equations if self._system is not None else ()
        return [equation for equation in equations if isinstance(equation, ExternalCall)]

    @cached_property
    def _results(self) -> list[Equation]:
        return needed(self._system.equations, outputs(self._system)) if self._system is not None else []

    def _place(self, item: Declared) -> str:
        return self.names.place(item.span.file, item.span.line)

    def files(self) -> dict[str, str]:
        """The header and the source."""
        return {f"{self.name}.h": self._header(), f"{self.name}.c": self._source()}

    def _header(self) -> str:
        environment, guard = self.environment, f"{self.name.upper()}_H"
        told = [*wrapped(environment.doc or f"The environment {environment.name}."), ""]
        told.append(f"Source: {self._place(environment)}")
        rows = [*comment(told), f"#ifndef {guard}", f"#define {guard}", "", '#include "network.h"', ""]
        rows += ["/* What stands behind the ports of the program. */"]
        rows += [f"extern const struct network_drivers {self.name}_drivers;"]
        rows += [f"extern const csp_environment {self.name};", "", "#endif", ""]
        return "\n".join(rows)

    def _source(self) -> str:
        rows = [f"/* See {self.name}.h. */", f'#include "{self.name}.h"', ""]
        rows += ['#include "constants.h"', '#include "csp_arithmetic.h"', '#include "types.h"']
        rows += sorted({f'#include "{body_name(call)}.h"' for call in self._calls})
        rows += ["", *self._plant(), *self._transfers()]
        system = self._system
        if system is not None and system.derivatives:
            rows += [*self._integration.function(self._slopes_printer, self._writer(self._slopes_printer, at=True)), ""]
        if self._results:
            rows += [*self._evaluate(), ""]
        rows += [*self._start(), "", *self._advance(), "", *self._drivers(), "", *self._table(), ""]
        return "\n".join(rows)

    # ---- The state

    def _plant(self) -> list[str]:
        rows = ["static struct {", f"{INDENT}int64_t now; /* in nanoseconds */"]
        system = self._system
        ports = {port_key(port): port for port in self.network.external_ports}
        for key, port in ports.items():
            name = self._members[key]
            kind = self.types.type_name(port.type)
            if _is_event(port):
                rows.append(f"{INDENT}{kind} {name}[2]; /* present and last */")
            else:
                rows.append(f"{INDENT}{kind} {name};")
        if system is not None:
            local = {name for call in self._calls for _, name, _ in call.outputs}
            kept = [(state.name, state.type) for state in system.states]
            kept += [(item.name, item.type) for item in system.constants if item.name in self._constants]
            kept += [(name, self._kinds[name]) for name in sorted(local)]
            rows += [f"{INDENT}{self.types.type_name(kind)} {self._members[name]};" for name, kind in kept]
            rows += [f"{INDENT}struct {body_name(call)} {self._members[call.name]};" for call in self._calls]
        return [*rows, "} plant;", ""]

    def _signal(self, name: str) -> str:
        """The place of a port's value, a state or a constant."""
        ports = {port_key(port): port for port in self.network.external_ports}
        if name in ports and _is_event(ports[name]):
            return f"plant.{self._members[name]}[0]"
        return f"plant.{self._members[name]}"

    def _printer(self, local: Iterable[str], time: str = "time") -> Printer:
        known = set(local)

        def lvalue(name: str) -> str:
            return self._members[name] if name in known else self._signal(name)

        return Printer(self.types, signal=lvalue, time=time)

    def _writer(self, printer: Printer, *, at: bool = False) -> EquationWriter:
        """``at``: in a function that does not say whether it has failed, whose caller looks."""

        def check(place: str) -> list[str]:
            if not at:
                return [f"CSP_CHECK_LAW({quoted(place)});"]
            return [f"csp_fault_in({quoted(place)});"] if place else []

        return EquationWriter(printer, self._place, check, lambda name: f"plant.{self._members[name]}", body_name)

    # ---- What happens

    @cached_property
    def _integration(self) -> Integration:
        system = self._system
        assert system is not None
        return Integration(
            name=f"{self.name}_slopes",
            owner="",
            local=lambda name: self._members[name],
            types=self._kinds,
            states=tuple(state.name for state in system.states if state.continuous),
            held=tuple(held(system)),
            equations=system.derivative_equations,
            derivatives=system.derivatives,
            method=system.method,
        )

    @cached_property
    def _slopes_printer(self) -> Printer:
        integration = self._integration
        inner = [*integration.states, *integration.held, *(equation.name for equation in integration.equations)]
        return self._printer(inner)

    def _start(self) -> list[str]:
        rows = [f"static bool {self.name}_start(void)", "{", f"{INDENT}plant.now = 0;"]
        system = self._system
        if system is not None:
            printer = self._printer((), "0.0")
            writer = self._writer(printer, at=True)
            for constant in constants_needed(system):
                rows += writer.assign(self._signal(constant.name), constant.value, self._place(constant))
            for call in self._calls:
                given = [
                    f"&plant.{self._members[call.name]}",
                    *(str(printer.print(value)) for _, value in call.arguments),
                ]
                rows += statement("", f"{body_name(call)}_initialize({', '.join(given)})", ";", INDENT)
            for state in system.states:
                rows += writer.assign(self._signal(state.name), state.initial, self._place(state))
        if self._results:
            rows.append(f"{INDENT}(void){self.name}_evaluate();")
        for port in self.network.external_ports:
            if _is_event(port):
                member = self._members[port_key(port)]
                rows.append(f"{INDENT}plant.{member}[1] = plant.{member}[0];")
        return [*rows, f"{INDENT}return !csp_faulted();", "}"]

    def _advance(self) -> list[str]:
        rows = [f"static bool {self.name}_advance(int64_t now)", "{"]
        system = self._system
        if system is not None and system.states:
            rows += self._moved(system)
        rows.append(f"{INDENT}plant.now = now;")
        rows.append(f"{INDENT}return {f'{self.name}_evaluate()' if self._results else 'true'};")
        return [*rows, "}"]

    def _moved(self, system: SubmodelClass) -> list[str]:
        """From the last instant to ``now``: next values and slopes come from the inputs as they are."""
        integrates = bool(system.derivatives)
        roots = {*signals((system.next_values,)), *(self._integration.held if integrates else ())}
        equations = needed(system.equations, roots, calls=False)
        continuous = [state.name for state in system.states if state.continuous] if integrates else []
        discrete = self._read_late(system)
        local = [*continuous, *discrete, *(name for equation in equations for name in defined(equation))]
        printer = self._printer(local)
        writer = self._writer(printer)
        rows: list[str] = []
        if uses_time((equations, system.next_values)) or (integrates and self._integration.timed):
            rows.append(f"{INDENT}const double time = csp_seconds(plant.now);")
        rows += [
            f"{INDENT}{self._declared(name, fixed=name not in continuous)} = {self._signal(name)};"
            for name in (*discrete, *continuous)
        ]
        rows += writer.equations(equations, self._declared)
        places = {state.name: self._place(state) for state in system.states}
        if system.next_values:
            inner = EquationWriter(printer, self._place, writer.check, writer.external, body_name, INDENT * 2)
            rows.append(f"{INDENT}if (now % ({duration(self.environment.step)}) == 0) {{")
            for name, value in system.next_values:
                rows += inner.assign(self._signal(name), value, places[name])
            rows.append(f"{INDENT}}}")
        if integrates:
            last = [self._place(equation) for equation in equations] + [places[name] for name, _ in system.next_values]
            rows += self._integrated(system, printer, last[-1] if last else None)
        return rows

    def _read_late(self, system: SubmodelClass) -> list[str]:
        """Discrete states that are read after they may have changed."""
        changed: set[str] = set()
        late: set[str] = set()
        for name, value in system.next_values:
            late |= set(signals((value,))) & changed
            changed.add(name)
        if system.derivatives:
            late |= set(self._integration.held) & changed
        return [state.name for state in system.states if state.name in late and not state.continuous]

    def _declared(self, name: str, *, fixed: bool = True) -> str:
        return f"{'const ' if fixed else ''}{self.types.type_name(self._kinds[name])} {self._members[name]}"

    def _integrated(self, system: SubmodelClass, printer: Printer, place: str | None) -> list[str]:
        interval = "csp_seconds(now - plant.now)"
        count: str | None = None
        rows: list[str] = []
        if system.step is None:
            rows.append(f"{INDENT}const double h = {interval};")
        else:
            count = "steps"
            # Whole division rounded up: exact, as the interval is not negative.
            step = duration(system.step)
            rows.append(f"{INDENT}const int64_t steps = (now - plant.now + {system.step - 1}) / ({step});")
            rows.append(f"{INDENT}const double h = {interval} / (double)steps;")
        rows += self._integration.steps(self._slopes_printer, printer.signal, count, INDENT)
        for state in self._integration.states:
            rows.append(f"{INDENT}{self._members[state]} = csp_real({self._members[state]});")
        if self._integration.states:
            told = f"(void)csp_fault_at({quoted(place)});" if place is not None else ""
            rows += [
                f"{INDENT}if (csp_faulted()) {{",
                *([INDENT * 2 + told] if told else []),
                f"{INDENT * 2}return false;",
                f"{INDENT}}}",
            ]
        single = self.types.type_name
        for state in self._integration.states:
            cast = "(float)" if single(self._kinds[state]) == "float" else ""
            rows.append(f"{INDENT}{self._signal(state)} = {cast}{self._members[state]};")
        return rows

    def _evaluate(self) -> list[str]:
        assert self._system is not None
        equations = self._results
        results = outputs(self._system)
        kept = {*results, *(name for call in self._calls for _, name, _ in call.outputs)}
        local = [name for equation in equations for name in defined(equation) if name not in kept]
        printer = self._printer(local)
        writer = self._writer(printer)
        rows = [f"static bool {self.name}_evaluate(void)", "{"]
        if uses_time((tuple(part for equation in equations for part in values(equation)),)):
            rows.append(f"{INDENT}const double time = csp_seconds(plant.now);")
        rows += writer.equations(equations, lambda name: self._signal(name) if name in kept else self._declared(name))
        return [*rows, f"{INDENT}return true;", "}"]

    # ---- What the ports of the program meet

    def _transfers(self) -> list[str]:
        """Functions that read and write signals, one for each type."""
        rows: list[str] = []
        done: set[str] = set()
        for port in self.network.external_ports:
            name, kind = self._transfer(port), self.types.type_name(port.type)
            if name in done:
                continue
            done.add(name)
            if port.direction == "out":
                rows += [f"static void {name}(void *device, const void *value)", "{"]
                rows += [f"{INDENT}*({kind} *)device = *(const {kind} *)value;", "}", ""]
            elif not _is_event(port):
                rows += [f"static bool {name}(void *device, void *value)", "{"]
                rows += [f"{INDENT}*({kind} *)value = *(const {kind} *)device;", f"{INDENT}return true;", "}", ""]
            else:
                rows += self._event_reader(name, kind, port.type)
        return rows

    def _event_reader(self, name: str, kind: str, type_: Type) -> list[str]:
        """The value of an event port, and whether it has changed since the last time."""
        if isinstance(type_, StructType | ArrayType):
            changed = f"!{self.types.suffix(type_)}_equal(signal[0], signal[1])"
        else:
            changed = "signal[0] != signal[1]"
        return [
            f"/* The present and the last value: an event is a change. */\nstatic bool {name}(void *device, void *value)", "{",
            f"{INDENT}{kind} *const signal = device;", f"{INDENT}const bool changed = {changed};",
            f"{INDENT}signal[1] = signal[0];", f"{INDENT}*({kind} *)value = signal[0];", f"{INDENT}return changed;", "}", "",
        ]  # fmt: skip

    def _transfer(self, port: ExternalPort) -> str:
        verb = "write" if port.direction == "out" else "poll" if _is_event(port) else "read"
        return f"{verb}_{self.types.suffix(port.type)}"

    def _drivers(self) -> list[str]:
        rows = [f"const struct network_drivers {self.name}_drivers = {{"]
        for names, ports in port_groups(self.network.external_ports):
            entries = []
            for port in ports:
                function = self._transfer(port)
                member = f"{'' if _is_event(port) else '&'}plant.{self._members[port_key(port)]}"
                halves = f"NULL, {function}" if port.direction == "out" else f"{function}, NULL"
                entries.append(f"{{{member}, {halves}}}")
            member = self.types.field(names)
            value = entries[0] if ports[0].index is None else f"{{{', '.join(entries)}}}"
            rows += statement(f".{member} = ", value, ",", INDENT)
        if not self.network.external_ports:
            rows.append(f"{INDENT}0")
        return [*rows, "};"]

    def _table(self) -> list[str]:
        step = duration(self.environment.step)
        return statement(f"const csp_environment {self.name} = ", f"{{{step}, {self.name}_start, {self.name}_advance}}")


def port_key(port: ExternalPort) -> str:
    """The name of an external port, with its index."""
    if port.index is None or port.name.endswith("]"):
        return port.name
    return f"{port.name}[{port.index}]"


def _is_event(port: ExternalPort) -> bool:
    return port.direction == "in" and port.period is None


def port_groups(ports: Sequence[ExternalPort]) -> list[tuple[str, list[ExternalPort]]]:
    """The ports by member of `struct network_drivers`: elements of an array together."""
    groups: dict[str, list[ExternalPort]] = {}
    for port in ports:
        groups.setdefault(port.name.partition("[")[0], []).append(port)
    return list(groups.items())


def environment_files(environment: Environment, network: Network, names: PackageNames, types: CTypes) -> dict[str, str]:
    """The header and the source of an environment."""
    return EnvironmentFiles(environment, network, names, types).files()
