"""The file that builds the network: the only one that knows what stands behind the ports."""

from __future__ import annotations

from collections.abc import Iterator

from cspdiag.base.record import record
from cspdiag.codegen.c.network.environments import port_groups, port_key
from cspdiag.codegen.c.network.network_names import names_file
from cspdiag.codegen.c.process.leaves import ports_header
from cspdiag.codegen.c.process.levels import Levels
from cspdiag.codegen.c.process.port_layout import PortLayout
from cspdiag.codegen.c.process.processes import Facts, ProcessFiles, process_files
from cspdiag.codegen.c.process.unwritten import Unwritten
from cspdiag.codegen.c.text.code import broken
from cspdiag.codegen.c.text.documents import comment
from cspdiag.codegen.c.text.literals import quoted
from cspdiag.codegen.c.text.names import Names, PackageNames
from cspdiag.codegen.c.text.rows import Row, block, lines, rows
from cspdiag.codegen.c.text.types import CTypes, duration
from cspdiag.network.ir.expressions import Value
from cspdiag.network.ir.network import ExternalPort, Network, ProcessClass

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
    facts = Facts(Levels(network), Unwritten(network))
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
    writer = _NetworkFiles(network, names, types, facts.levels)
    files |= {"network.h": writer.header(), "network.c": writer.source(), "csp_config.h": writer.configuration()}
    return files | {"network_names.c": names_file(network, types, described)}


@record
class _NetworkFiles:
    network: Network
    names: PackageNames
    types: CTypes
    levels: Levels

    @property
    def top(self) -> ProcessClass:
        found = self.network.class_named(self.network.top)
        assert isinstance(found, ProcessClass)
        return found

    def configuration(self) -> str:
        """What the kernel has to provide for."""
        return "\n".join(
            [
                "/* What the program needs of the kernel. */",
                "#ifndef CSP_CONFIG_H",
                "#define CSP_CONFIG_H",
                "",
                "#ifndef CSP_TRACE",
                "#define CSP_TRACE 0 /* whether communications, processes and groups are reported to csp_observe... */",
                "#endif",
                f"#define CSP_LEVELS {self.levels.count}U /* of priority */",
                "",
                "#endif",
                "",
            ]
        )

    def header(self) -> str:
        """What runs a program needs."""
        told = [f"The network of {self.network.top}: its processes, its channels, and what stands behind its ports."]
        found = [*comment(told), "#ifndef NETWORK_H", "#define NETWORK_H", "", '#include "csp.h"']
        found += ['#include "types.h"', ""] if self._events else [""]
        found += ["/* A device or a simulated one for every port. */"]
        members = [Row(*driver) for driver in _driver_members(self.network, self.types)]
        found += [*lines(block("struct network_drivers", members or [Row("char unused;")], "};")), ""]
        found += ["/* Builds the network, before each run. */"]
        found += ["void network_initialize(const struct network_drivers *drivers);", ""]
        found += self._bringers_declared()
        found += ["extern const csp_program network_program;", ""]
        found += [
            "#if CSP_TRACE",
            "/* By number: channels and ports, and the sizes of their values; processes and groups. */",
        ]
        found += ["extern const uint32_t network_channel_count;", "extern const char *const network_channel_names[];"]
        found += ["extern const uint16_t network_channel_sizes[];", "extern const uint32_t network_process_count;"]
        found += [
            "extern const char *const network_process_names[];",
            "extern const char *const network_process_kinds[];",
        ]
        return "\n".join([*found, "#endif", "", "#endif", ""])

    def source(self) -> str:
        """The memory of the whole program, and the function that connects its parts."""
        struct = self.names.classes[self.network.top]
        members = self._members()
        found = ['#include "network.h"', "", '#include "constants.h"', f'#include "{struct}.h"', ""]
        found += ["/* All memory of the program. */", f"static struct {struct} {struct};"]
        fields = [Row(f"{_STRUCTS[kind_of(port)]} {members[port_key(port)]};") for port in self.network.external_ports]
        values = [
            Row(f"{self.types.type_name(port.type)} {members[port_key(port)]};")
            for port in self.network.external_ports
            if kind_of(port) != "direct"
        ]
        if fields:
            found += lines(block("static struct", fields, "} external;"))
        if values:
            found += lines(block("static struct", values, "} present;"))
        if self._events:
            brought = [Row(f"{self.types.type_name(port.type)} {members[port_key(port)]};") for port in self._events]
            found += lines(block("static struct", brought, "} brought; /* by interrupt handlers */"))
        found += ["", *self._safe_values(members), *self._table(members)]
        found += [
            "void network_initialize(const struct network_drivers *drivers)",
            *lines(block("", self._building(members))),
        ]
        found += ["", *self._bringers(members), *self._reports(), *self._program(struct)]
        return "\n".join([*found, ""])

    def _members(self) -> Names:
        members = Names()
        for port in self.network.external_ports:
            members[port_key(port)]
        return members

    @property
    def _events(self) -> list[ExternalPort]:
        return [port for port in self.network.external_ports if kind_of(port) == "event"]

    def _bringer(self, port: ExternalPort, members: Names) -> list[str]:
        member = members[port_key(port)]
        return broken(f"void network_bring_{member}({self.types.type_name(port.type)} value)", "        ")

    def _bringers_declared(self) -> list[str]:
        if not self._events:
            return []
        found = ["/* An interrupt handler brings an event: the latest value counts. */"]
        for port in self._events:
            *rest, last = self._bringer(port, self._members())
            found += [*rest, f"{last};"]
        return [*found, ""]

    def _bringers(self, members: Names) -> list[str]:
        found: list[str] = []
        for port in self._events:
            body = rows(f"csp_event_bring(&external.{members[port_key(port)]}, &value);")
            found += [*self._bringer(port, members), *lines(block("", body)), ""]
        return found

    def _safe_values(self, members: Names) -> list[str]:
        found = [
            Row(
                f"static const {self.types.type_name(port.type)} safe_{members[port_key(port)]} = "
                f"{self.types.initializer(self._safe(port), port.type)};"
            )
            for port in self.network.external_ports
            if port.direction == "out"
        ]
        return [*lines(found), ""] if found else []

    def _safe(self, port: ExternalPort) -> Value:
        return self.types.zero(port.type) if port.safe is None else port.safe

    def _table(self, members: Names) -> list[str]:
        entries = []
        for port in self.network.external_ports:
            name = members[port_key(port)]
            safe = f", .safe = &safe_{name}" if port.direction == "out" else ""
            told = quoted(f"{self.network.top}.{port_key(port)}")
            entries.append(
                f"{{.kind = {_KINDS[kind_of(port)]}, .medium = &external.{name}.medium{safe}, .name = {told}}}"
            )
        if not entries:
            return []
        body = [Row(f"{entry},") for entry in entries[:-1]] + [Row(entries[-1])]
        return [*lines(block("static const csp_port port_table[] =", body, "};")), ""]

    def _building(self, members: Names) -> list[Row]:
        top = self.names.classes[self.network.top]
        found = rows(
            "csp_numbers numbers = {.process = 1U, .channel = 0U};",
            "csp_begin_building();",
            f"(void)memset(&{top}, 0, sizeof({top}));",
        )
        if self.network.external_ports:
            found += rows("(void)memset(&external, 0, sizeof(external));")
        drivers = dict(
            zip(
                (port_key(port) for port in self.network.external_ports),
                _driver_lvalues(self.network, self.types),
                strict=True,
            )
        )
        for number, port in enumerate(self.network.external_ports):
            key = port_key(port)
            name, driver = members[key], drivers[key]
            medium, value = f"&external.{name}", f"&present.{name}"
            kind = kind_of(port)
            period = "" if port.period is None else str(duration(port.period))
            match kind:
                case "sampled":
                    call = f"csp_sampled_input_init({medium}, {number}U, {period}, {value}, {driver});"
                case "event":
                    broadcast = "true" if port.kind == "broadcast" else "false"
                    call = f"csp_event_input_init({medium}, {number}U, {broadcast}, {value}, {driver});"
                case "latched":
                    call = f"csp_latched_output_init({medium}, {number}U, {period}, {value}, {driver});"
                case _:
                    call = f"csp_direct_output_init({medium}, {number}U, {driver});"
            found.append(Row(call))
            if kind == "event":
                found.append(Row(f"csp_event_input_accept({medium}, &brought.{name}, sizeof(brought.{name}));"))
            if port.direction == "out":
                found.append(Row(f"external.{name}.name = {quoted(f'{self.network.top}.{key}')};"))
        if not self.network.external_ports:
            found.append(Row("(void)drivers;"))
        else:
            found.append(Row(f"numbers.channel = {len(self.network.external_ports)}U;"))
        found.append(Row(f"{self._initialize()};"))
        return found

    def _initialize(self) -> str:
        struct, layout, members = self.names.classes[self.network.top], PortLayout(self.top), self._members()
        fields = []
        for port in self.network.external_ports:
            designator = layout.designator(port.name.partition("[")[0], port.index)
            if designator is not None:
                fields.append(f".{designator} = &external.{members[port_key(port)]}")
        given = [f"&{struct}", "&numbers"]
        if fields:
            given.append(f"&(const struct {struct}_ports){{{', '.join(fields)}}}")
        values = dict(self.network.arguments)
        for item in self.top.parameters:
            given.append(str(self.types.literal(values[item.name], item.type)))
        return f"{struct}_initialize({', '.join(given)})"

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

    def _program(self, struct: str) -> list[str]:
        exceptions = [name for name in self.network.exceptions if name in self.names.exceptions]
        found: list[str] = []
        if exceptions:
            listed = ", ".join(quoted(name) for name in exceptions)
            found += [*broken(f"static const char *const exception_names[] = {{{listed}}};", "    "), ""]
        count = len(self.network.external_ports)
        return [
            *found,
            "const csp_program network_program = {",
            f"    .process = &{struct}.process,",
            *(["    .ports = port_table,", f"    .port_count = {count}U,"] if count else []),
            *(["    .exception_names = exception_names,"] if exceptions else []),
            "#if CSP_TRACE",
            "    .process_name = process_name,",
            "    .channel_name = channel_name,",
            "#endif",
            "};",
        ]


def kind_of(port: ExternalPort) -> str:
    """What an external port is for the kernel."""
    if port.direction == "in":
        return "event" if port.period is None else "sampled"
    return "direct" if port.period is None or port.immediate else "latched"


def _driver_lvalues(network: Network, types: CTypes) -> Iterator[str]:
    """The driver of each port, in order, as the function that builds the network has it."""
    for name, ports in port_groups(network.external_ports):
        for position, port in enumerate(ports):
            yield f"drivers->{types.field(name)}{'' if port.index is None else f'[{position}]'}"


def _driver_members(network: Network, types: CTypes) -> Iterator[tuple[str, int, str]]:
    """The declarations of the members of ``struct network_drivers``, and what their functions are handed a pointer to."""
    for name, ports in port_groups(network.external_ports):
        member = f"csp_driver {types.field(name)}{'' if ports[0].index is None else f'[{len(ports)}]'};"
        access = "reads" if ports[0].direction == "in" else "writes"
        yield member, 0, f"{access} {types.type_name(ports[0].type)}"
