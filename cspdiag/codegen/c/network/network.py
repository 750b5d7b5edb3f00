"""The file that builds the network: the only one that knows the devices behind the ports."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import takewhile
from typing import assert_never

from cspdiag.base.record import record
from cspdiag.codegen.c.network.external_ports import port_groups
from cspdiag.codegen.c.network.network_names import names_file
from cspdiag.codegen.c.network.parameters import ParameterText
from cspdiag.codegen.c.process.leaves import ports_header
from cspdiag.codegen.c.process.levels import Levels
from cspdiag.codegen.c.process.processes import NetworkFacts, ProcessFiles, process_files
from cspdiag.codegen.c.process.struct.port_layout import PortLayout
from cspdiag.codegen.c.process.struct.unwritten import Unwritten
from cspdiag.codegen.c.text.code import CSP, Aggregate, Code, address, call, code, ignored, own, unsigned
from cspdiag.codegen.c.text.documents import comment
from cspdiag.codegen.c.text.literals import quoted
from cspdiag.codegen.c.text.names import Names, PackageNames
from cspdiag.codegen.c.text.statements import (
    Blank,
    Block,
    Function,
    Remark,
    Statement,
    define,
    lines,
    return_value,
    run,
    signature,
    store,
)
from cspdiag.codegen.c.text.types import CTypes, duration
from cspdiag.network.ir.expressions import Value
from cspdiag.network.ir.network import ExternalPort, Network, ProcessClass
from cspdiag.network.ir.zero import zero
from cspdiag.network.lower.environments import grid_of

_BUILDING = ("struct network *self", "const struct network_drivers *drivers", "const csp_hooks *hooks")
"""The parameters of the function that builds the network."""
_STRUCTS = {
    "sampled": "csp_sampled_input",
    "event": "csp_event_input",
    "latched": "csp_latched_output",
    "direct": "csp_direct_output",
}
_KINDS = {
    "sampled": "CSP_PORT_SAMPLED",
    "event": "CSP_PORT_EVENT",
    "latched": "CSP_PORT_LATCHED",
    "direct": "CSP_PORT_DIRECT",
}


def network_files(network: Network, names: PackageNames, types: CTypes) -> dict[str, str]:
    """The pairs of files of all process classes, `network.h`, `network.c`, `network_names.c` and `csp_config.h`."""
    facts = NetworkFacts(Levels(network), Unwritten(network))
    files: dict[str, str] = {}
    described: dict[str, ProcessFiles] = {}
    for class_ in network.classes:
        if not isinstance(class_, ProcessClass):
            continue
        if class_.external is not None:
            files |= ports_header(class_, names, types)
        else:
            described[class_.name] = process_files(class_, network, names, types, facts)
            files |= described[class_.name].files
    variables = any(item.variables for item in described.values())
    writer = _NetworkFiles(network, names, types, facts.levels, variables)
    files |= {"network.h": writer.header(), "network.c": writer.source(), "csp_config.h": writer.configuration()}
    return files | {"network_names.c": names_file(network, types, described)}


@record
class _NetworkFiles:
    network: Network
    names: PackageNames
    types: CTypes
    levels: Levels
    variables: bool
    """Whether there are variables that may be read before they were written."""

    @property
    def top(self) -> ProcessClass:
        found = self.network.class_named(self.network.top)
        assert isinstance(found, ProcessClass)
        return found

    def configuration(self) -> str:
        """The configuration of the kernel for this program."""
        return "\n".join(
            [
                "/* What the program needs of the kernel. */",
                "#ifndef CSP_CONFIG_H",
                "#define CSP_CONFIG_H",
                "",
                "#ifndef CSP_TRACE",
                "#define CSP_TRACE 0 /* whether communications, processes and groups are observed */",
                "#endif",
                f"#define CSP_LEVELS {self.levels.count}U /* of priority */",
                "",
                '#include "csp_names.h"',
                "",
                "#endif",
                "",
            ]
        )

    def header(self) -> str:
        """What a `main` that runs the program needs."""
        about = [f"The network of {self.network.top}: its processes, its channels, and what is behind its ports."]
        struct = self.names.classes[self.network.top]
        rows = [*comment(about), "#ifndef NETWORK_H", "#define NETWORK_H", "", '#include "csp.h"']
        rows += [f'#include "{struct}.h"', '#include "types.h"', ""]
        rows += ["/* All memory of the program. */"]
        rows += [*lines([Block(tuple(self._memory(struct)), "struct network", "};")]), ""]
        rows += ["/* A device or a simulated one for every port. */"]
        members = [*_driver_members(self.network, self.types)] or [define("char", "unused")]
        rows += [*lines([Block(tuple(members), "struct network_drivers", "};")]), ""]
        rows += ["/* Builds the network, before each run; csp_build says what the hooks are. */"]
        rows += [*signature("void network_initialize", (*_BUILDING, *self._parameters.given), ";"), ""]
        rows += self._parameters.declarations()
        rows += self._bring_declarations()
        rows += ["extern const csp_program network_program;", ""]
        if self.variables:
            about_names = "/* By number: variables that may be read before they were written. */"
            rows += [about_names, "extern const char *const network_variable_names[];", ""]
        rows += [
            "#if CSP_TRACE || CSP_MEASURE || CSP_TRACE_HOOK",
            "/* By number: channels and ports, and the sizes of their values; processes and groups. */",
        ]
        rows += ["extern const uint32_t network_channel_count;", "extern const char *const network_channel_names[];"]
        rows += ["extern const uint32_t network_channel_sizes[];", "extern const uint32_t network_process_count;"]
        rows += [
            "extern const char *const network_process_names[];",
            "extern const char *const network_process_kinds[];",
        ]
        return "\n".join([*rows, "#endif", "", "#endif", ""])

    def _memory(self, struct: str) -> Iterator[Statement]:
        """The members of the structure with all state of a program: first the kernel, to which offsets refer."""
        members = self._members()
        yield define("csp_kernel", "kernel")
        yield from self._parameters.memory()
        yield define(f"struct {struct}", "top", remark="the outermost process, with all others inside")
        ports = [(port, members[port.key]) for port in self.network.external_ports]
        fields = [define(_STRUCTS[port.medium], name) for port, name in ports]
        values = [define(self.types.type_name(port.type), name) for port, name in ports if port.medium != "direct"]
        brought = [define(self.types.type_name(port.type), name) for port, name in ports if port.medium == "event"]
        for body, tail in (
            (fields, "external;"),
            (values, "present;"),
            (brought, "brought; /* by interrupt handlers */"),
        ):
            if body:
                yield Block(tuple(body), "struct", f"}} {tail}")

    def source(self) -> str:
        """The function that connects the parts of the program."""
        members = self._members()
        rows = ['#include "network.h"', "", '#include "constants.h"', ""]
        rows += [*self._safe_values(members), *self._table(members)]
        program = self._program()
        given = (*_BUILDING, *self._parameters.given)
        building = Function("void network_initialize", given, tuple(self._initialization(members)))
        rows += [*self._reports(), *self._parameters.functions(), *program, "", *lines([building])]
        brings = self._bring_functions(members)
        rows += ["", *brings] if brings else []
        return "\n".join([*rows, ""])

    @property
    def _parameters(self) -> ParameterText:
        return ParameterText(self.network, self.names, self.types)

    def _members(self) -> Names:
        members = Names(self.names.macros)
        for port in self.network.external_ports:
            members[port.key]
        return members

    @property
    def _events(self) -> list[ExternalPort]:
        return [port for port in self.network.external_ports if port.medium == "event"]

    def _bring_signature(self, port: ExternalPort, members: Names) -> tuple[str, tuple[str, ...]]:
        head = f"bool network_bring_{members[port.key]}"
        return head, ("struct network *self", f"{self.types.type_name(port.type)} value")

    def _bring_declarations(self) -> list[str]:
        if not self._events:
            return []
        rows = ["/* An interrupt handler brings an event; the latest counts. True: one before it is unread. */"]
        for port in self._events:
            rows += signature(*self._bring_signature(port, self._members()), ";")
        return [*rows, ""]

    def _bring_functions(self, members: Names) -> list[str]:
        statements: list[Statement] = []
        for port in self._events:
            latest = address(_external(members[port.key]))
            body = return_value(call("csp_event_bring", "&self->kernel", latest, "&value"))
            statements += [*([Blank()] if statements else []), Function(*self._bring_signature(port, members), (body,))]
        return lines(statements)

    def _safe_values(self, members: Names) -> list[str]:
        statements: list[Statement] = [
            define(
                f"static const {self.types.type_name(port.type)}",
                f"safe_{members[port.key]}",
                self.types.initial(self._safe(port), port.type),
            )
            for port in self.network.external_ports
            if port.direction == "out"
        ]
        return lines([*statements, Blank()]) if statements else []

    def _safe(self, port: ExternalPort) -> Value:
        return zero(port.type) if port.safe is None else port.safe

    def _table(self, members: Names) -> list[str]:
        ports = self.network.external_ports
        entries: list[tuple[None, Code]] = [
            (None, self._port(port, members[port.key], _alike(ports[index:]))) for index, port in enumerate(ports)
        ]
        table = Aggregate(tuple(entries))
        return lines([store("static const csp_port port_table[]", table), Blank()]) if entries else []

    def _port(self, port: ExternalPort, name: str, alike: int) -> Aggregate:
        parts: list[tuple[str, Code]] = [(".kind", code(_KINDS[port.medium]))]
        parts.append((".medium", call("offsetof", "struct network", f"external.{name}.medium")))
        if port.direction == "out":
            parts.append((".safe", code(f"&safe_{name}")))
        parts.append((".name", code(quoted(f"{self.network.top}.{port.key}"))))
        if alike:
            parts.append((".alike", unsigned(alike)))
        return Aggregate(tuple(parts))

    def _initialization(self, members: Names) -> list[Statement]:
        ports = self.network.external_ports
        numbers = Aggregate(((".csp", code("csp")), (".process", unsigned(1)), (".channel", unsigned(0))))
        statements: list[Statement] = [
            define("csp_kernel *const", "csp", "&self->kernel"),
            define("csp_numbers", "numbers", numbers),
            run(ignored(call("memset", "self", "0", call("sizeof", "*self")))),
            run(call("csp_build", CSP, "&network_program", "hooks")),
            *self._parameters.initialization(),
        ]
        drivers = _driver_lvalues(self.network, self.types)
        for number, (port, driver) in enumerate(zip(ports, drivers, strict=True)):
            statements += self._port_initialization(port, members[port.key], unsigned(number), address(driver))
        statements.append(store("numbers.channel", unsigned(len(ports))) if ports else run("(void)drivers"))
        statements.append(run(self._initialize()))
        return statements

    def _port_initialization(self, port: ExternalPort, name: str, number: Code, driver: Code) -> list[Statement]:
        """The statements that initialize a port and connect it to its driver."""
        medium, value = address(_external(name)), f"&self->present.{name}"
        period = code("") if port.sampling is None else duration(port.sampling.period)
        statements: list[Statement] = []
        match port.medium:
            case "sampled":
                statements.append(run(call("csp_sampled_input_init", medium, number, period, value, driver)))
            case "event":
                broadcast = "true" if port.kind == "broadcast" else "false"
                statements.append(run(call("csp_event_input_init", medium, number, broadcast, value, driver)))
                brought = own("brought").field(name)
                size = call("sizeof", brought)
                statements.append(run(call("csp_event_input_accept", medium, address(brought), size)))
            case "latched":
                statements.append(run(call("csp_latched_output_init", medium, number, period, value, driver)))
            case "direct":
                statements.append(run(call("csp_direct_output_init", medium, number, driver)))
            case _:
                assert_never(port.medium)
        if port.sampling is not None and port.sampling.offset and port.medium != "direct":
            statements.append(store(_external(name).field("next"), duration(port.sampling.offset)))
        if port.direction == "out":
            name_of_port = quoted(f"{self.network.top}.{port.key}")
            statements.append(store(_external(name).field("name"), name_of_port))
        return statements

    def _initialize(self) -> Code:
        struct, members = self.names.classes[self.network.top], self._members()
        layout = PortLayout(self.top, self.names.macros)
        fields: list[tuple[str, Code]] = []
        for port in self.network.external_ports:
            designator = layout.designator(port.name.partition("[")[0], port.index)
            if designator is not None:
                fields.append((f".{designator}", address(_external(members[port.key]))))
        arguments: list[Code] = [address(own("top")), code("&numbers")]
        if fields:
            arguments.append(address(Aggregate(tuple(fields), f"const struct {struct}_ports")))
        values = dict(self.network.arguments)
        tunable = dict(self.network.tunable)
        arguments += [
            self._parameters.reference(tunable[item.name])
            if item.tunable
            else self.types.literal(values[item.name], item.type)
            for item in self.top.parameters
        ]
        return call(f"{struct}_initialize", *arguments)

    def _reports(self) -> list[str]:
        return [
            "/* Names are built in where communications are reported. */",
            "#if CSP_TRACE",
            "static void copy_name(const char *name, char *text, size_t size)",
            "{",
            "    size_t length = strlen(name);",
            "    if (length >= size) {",
            "        length = size - 1U;",
            "    }",
            "    (void)memcpy(text, name, length);",
            "    text[length] = '\\0';",
            "}",
            "",
            "static void process_name(uint32_t number, char *text, size_t size)",
            "{",
            "    copy_name(network_process_names[number], text, size);",
            "}",
            "",
            "static void channel_name(uint32_t number, char *text, size_t size)",
            "{",
            "    copy_name(network_channel_names[number], text, size);",
            "}",
            "#endif",
            "",
        ]

    def _program(self) -> list[str]:
        exceptions = [name for name in self.network.exceptions if name in self.names.exceptions]
        rows: list[str] = []
        if exceptions:
            listed = Aggregate(tuple((None, code(quoted(name))) for name in exceptions))
            rows += [*lines([store("static const char *const exception_names[]", listed)]), ""]
        count = len(self.network.external_ports)
        return [
            *rows,
            "const csp_program network_program = {",
            "    .process = offsetof(struct network, top.process),",
            *(["    .ports = port_table,", f"    .port_count = {count}U,"] if count else []),
            *self._grid(),
            *(["    .exception_names = exception_names,"] if exceptions else []),
            *(
                ["#if CSP_USES_TEXTS", "    .variable_names = network_variable_names,", "#endif"]
                if self.variables
                else []
            ),
            *self._parameters.program(),
            "#if CSP_TRACE",
            "    .process_name = process_name,",
            "    .channel_name = channel_name,",
            "#endif",
            "};",
        ]

    def _grid(self) -> list[str]:
        """How often devices are polled for events."""
        ports = self.network.external_ports
        return [f"    .grid = {duration(grid_of(ports))},"] if any(port.medium == "event" for port in ports) else []


def _alike(ports: Sequence[ExternalPort]) -> int:
    """How many ports right after the first one are sampled or handed over at its ticks."""
    first = ports[0]
    if first.medium not in ("sampled", "latched"):
        return 0
    same = (port.medium == first.medium and port.sampling == first.sampling for port in ports[1:])
    return sum(1 for _ in takewhile(bool, same))


def _external(name: str) -> Code:
    return own("external").field(name)


def _driver_lvalues(network: Network, types: CTypes) -> Iterator[Code]:
    """The lvalue of the driver of each port, in order, in the function that builds the network."""
    for name, ports in port_groups(network.external_ports):
        for position, port in enumerate(ports):
            member = code("drivers").arrow(types.field(name))
            yield member if port.index is None else member.at(position)


def _driver_members(network: Network, types: CTypes) -> Iterator[Statement]:
    """The declarations of the members of ``struct network_drivers``, with remarks on what their functions are given a
    pointer to.
    """
    for name, ports in port_groups(network.external_ports):
        access = "reads" if ports[0].direction == "in" else "writes"
        yield Remark(f"{access} {types.type_name(ports[0].type)}")
        yield define("csp_driver", f"{types.field(name)}{'' if ports[0].index is None else f'[{len(ports)}]'}")
