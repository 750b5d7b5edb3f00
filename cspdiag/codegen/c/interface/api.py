"""`NAME_api.h` and `NAME_api.c`: a program in steps that never wait, with all its state in memory of its owner."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from functools import cached_property
from zlib import crc32

from cspdiag.base.record import record
from cspdiag.codegen.c.interface.layout import Extent, Layout
from cspdiag.codegen.c.interface.pointers import pointer_files
from cspdiag.codegen.c.network.external_ports import port_groups
from cspdiag.codegen.c.text.code import EQUALITY, Aggregate, Code, code, conditional, infix
from cspdiag.codegen.c.text.documents import comment, value_remark
from cspdiag.codegen.c.text.names import Names, PackageNames
from cspdiag.codegen.c.text.statements import Block, Statement, define, lines, signature
from cspdiag.codegen.c.text.types import CTypes
from cspdiag.codegen.shared.names import with_underscores
from cspdiag.codegen.shared.render import Render
from cspdiag.model.types import ArrayType, EnumType, StructType
from cspdiag.network.ir.network import ExternalPort, Network

DEEPEST = 6
"""CSP_DEEPEST of the kernel."""


@record
class ApiText:
    """What the templates of the interface are given."""

    name: str
    """The prefix of functions and types."""
    top: str
    size: int
    small_size: int
    alignment: int
    """With pointers of 32 bits or less."""
    build: str
    """A number of eight hexadecimal digits that identifies the program and its kernel."""
    processes: int
    """The number of processes that are measured, numbered from 1."""
    measured: str
    """What is measured: each `process`, or a `thread` with those that the optimizer has inlined into it."""
    own_types: bool
    """Whether ports have types that the program defines."""
    inputs: bool
    outputs: bool
    events: bool
    port_names: str
    ports: list[str]
    event_names: str
    event_declarations: list[str]
    instance: str
    drivers: list[str]
    connect: str
    event_functions: list[str]
    parameters: bool
    """Whether the program has parameters."""
    parameter_names: str


@record
class Interface:
    """The interface of a program, whose names all begin with ``prefix``."""

    network: Network
    names: PackageNames
    types: CTypes
    inlined: bool
    """Whether processes may be inlined into others."""

    @property
    def prefix(self) -> str:
        """The name of the package."""
        return self.names.prefix

    @cached_property
    def members(self) -> Mapping[str, str]:
        """The members for the ports, by their keys; those of ``network.h``."""
        names = Names(self.names.macros)
        return {port.key: names[port.key] for port in self.network.external_ports}

    @cached_property
    def places(self) -> Mapping[str, str]:
        """Where ports are in the structures of inputs and outputs, by their keys: ``level``, ``lamps[2]``."""
        return {
            port.key: self.types.field(name) + ("" if port.index is None else f"[{position}]")
            for name, ports in port_groups(self.network.external_ports)
            for position, port in enumerate(ports)
        }

    @cached_property
    def events(self) -> list[ExternalPort]:
        """Inputs that functions bring."""
        return [port for port in self.network.external_ports if port.medium == "event"]

    @cached_property
    def inputs(self) -> list[ExternalPort]:
        """Inputs that are sampled."""
        return [port for port in self.network.external_ports if port.medium == "sampled"]

    @cached_property
    def outputs(self) -> list[ExternalPort]:
        """All outputs."""
        return [port for port in self.network.external_ports if port.direction == "out"]

    @cached_property
    def bringers(self) -> Mapping[str, str]:
        """The functions that bring events, by the keys of their ports."""
        return {port.key: self.names.public(port.key) for port in self.events}

    @cached_property
    def functions(self) -> Mapping[str, str]:
        """The functions behind the ports, by the keys of these."""
        brought = self.bringers  # these are named first, because users see them
        verbs = {"in": "read", "out": "write"}
        return {
            port.key: self.names.internal(
                f"{'poll' if port.key in brought else verbs[port.direction]}_{self.members[port.key]}"
            )
            for port in (*self.inputs, *self.events, *self.outputs)
        }

    @cached_property
    def literals(self) -> Mapping[str, str]:
        """The constants that name inputs, outputs and events, by the keys of their ports."""
        kinds = [*((port, "IN") for port in self.inputs), *((port, "OUT") for port in self.outputs)]
        kinds += [(port, "EVENT") for port in self.events]
        return {port.key: self.names.public_constant(f"{kind}_{port.key}") for port, kind in kinds}

    def text(self, extents: tuple[Extent, Extent], build: str, processes: int) -> ApiText:
        """What the templates are given, for instances with ``processes`` that take at most this: with pointers of 64
        bits, and with shorter ones.
        """
        return ApiText(
            name=self.prefix,
            top=self.network.top,
            size=extents[0].size,
            small_size=extents[1].size,
            alignment=max(extent.alignment for extent in extents),
            build=build,
            processes=processes,
            measured="thread" if self.inlined else "process",
            own_types=self.own_types,
            inputs=bool(self.inputs),
            outputs=bool(self.outputs),
            events=bool(self.events),
            port_names=self.port_names,
            ports=self.ports,
            event_names=self.event_names,
            event_declarations=self.event_declarations,
            instance=self.instance,
            drivers=self.drivers,
            connect=self.connect,
            event_functions=self.event_functions,
            parameters=bool(self.network.parameters),
            parameter_names=self.parameter_names,
        )

    @property
    def own_types(self) -> bool:
        """Whether ports or parameters have types that the program defines."""
        return bool(self.network.parameters) or any(
            isinstance(port.type, StructType | ArrayType | EnumType) for port in self.network.external_ports
        )

    # ---- The header

    @property
    def ports(self) -> list[str]:
        """The structures of inputs and outputs, with a name for each port."""
        groups = (self._ports("input", self.inputs, "Sampled inputs"), self._ports("output", self.outputs, "Outputs"))
        return ["\n".join(rows) for rows in groups if rows]

    def _ports(self, word: str, ports: Sequence[ExternalPort], title: str) -> list[str]:
        if not ports:
            return []
        name = self.prefix
        fields = [self._field(member, group) for member, group in port_groups(ports)]
        has_arrays = any(port.index is not None for port in ports)
        of_arrays = "; those of the elements of an array follow each other" if has_arrays else ""
        return [
            f"/* {title}, and a name for each{of_arrays}. */",
            *lines([Block(tuple(fields), f"typedef struct {name}_{word}s", f"}} {name}_{word}s;")]),
            *self._names(word, ports),
        ]

    def _field(self, name: str, ports: Sequence[ExternalPort]) -> Statement:
        """The member for a port, or for an array of ports."""
        first = ports[0]
        extent = "" if first.index is None else f"[{len(ports)}]"
        remark = value_remark(first.doc or "", first.type, first.sampling)
        return define(self.types.type_name(first.type), f"{self.types.field(name)}{extent}", remark=remark)

    def _names(self, word: str, ports: Sequence[ExternalPort]) -> list[str]:
        return self._enum(word, [self.literals[port.key] for port in ports])

    def _enum(self, word: str, literals: Sequence[str]) -> list[str]:
        rows = [f"    {literal}," for literal in literals]
        rows[-1] = rows[-1].removesuffix(",")
        return [f"typedef enum {self.prefix}_{word} {{", *rows, f"}} {self.prefix}_{word};"]

    @cached_property
    def port_names(self) -> str:
        """The numbers of the ports in traces; empty if there are none."""
        ports = self.network.external_ports
        literals = [self.names.public_constant(f"PORT_{port.key}") for port in ports]
        return "\n".join(self._enum("port", literals)) if literals else ""

    @cached_property
    def parameter_names(self) -> str:
        """The numbers of parameters, and of constants that follow from them; empty if there are none."""
        parameters = self.network.parameters
        literals = [self.names.public_constant(f"PARAMETER_{with_underscores(item.name)}") for item in parameters]
        return "\n".join(self._enum("parameter", literals)) if literals else ""

    @property
    def event_names(self) -> str:
        """A name for each event; empty if there are none."""
        return "\n".join(["/* A name for each event. */", *self._names("event", self.events)]) if self.events else ""

    @property
    def event_declarations(self) -> list[str]:
        """The declarations of the functions that bring events."""
        return ["\n".join([*self._about(port), *self._bringer(port, ";")]) for port in self.events]

    def _about(self, port: ExternalPort) -> list[str]:
        remark = value_remark(port.doc or "", port.type)
        return comment([remark]) if remark else []

    def _bringer(self, port: ExternalPort, tail: str) -> list[str]:
        parameters = (f"{self.prefix}_instance *self", f"{self.types.type_name(port.type)} value")
        return signature(f"bool {self.bringers[port.key]}", parameters, tail)

    # ---- The source

    @property
    def instance(self) -> str:
        """The definition of the structure with all state."""
        name = self.prefix
        fields: list[Statement] = [define("struct network", "network"), define(f"{name}_hooks", "hooks")]
        fields.append(define("csp_hooks", "kernel_hooks"))
        fields += [define(f"{name}_inputs", "inputs")] if self.inputs else []
        fields += [define(f"{name}_outputs", "outputs")] if self.outputs else []
        fields += [define("uint32_t", "build"), define("const csp_program *", "program")]
        fields.append(define("const void *", "place", remark="where it was begun"))
        fields.append(define("uint32_t", "checksum", remark="of a copy"))
        return "\n".join(lines([Block(tuple(fields), f"struct {name}_instance", "};")]))

    @property
    def drivers(self) -> list[str]:
        """The functions behind the ports, which call the hooks."""
        functions = [*map(self._reader, self.inputs), *map(self._poller, self.events), *map(self._writer, self.outputs)]
        return ["\n".join(rows) for rows in functions]

    @property
    def event_functions(self) -> list[str]:
        """The functions that bring events."""
        return ["\n".join([*self._bringer(port, ""), *self._brought(port)]) for port in self.events]

    def _brought(self, port: ExternalPort) -> list[str]:
        medium = f"&self->network.external.{self.members[port.key]}"
        return ["{", f"    return csp_event_bring(&self->network.kernel, {medium}, &value);", "}"]

    def _reader(self, port: ExternalPort) -> list[str]:
        place, name = self.places[port.key], self.prefix
        return [
            f"static bool {self.functions[port.key]}(void *device, void *value)",
            "{",
            f"    {name}_instance *const self = device;",
            f"    return sample_input(self, {self.literals[port.key]}, value, &self->inputs.{place}, "
            f"sizeof self->inputs.{place});",
            "}",
        ]

    def _poller(self, port: ExternalPort) -> list[str]:
        return [
            f"static bool {self.functions[port.key]}(void *device, void *value)",
            "{",
            f"    const {self.prefix}_instance *const self = device;",
            "    return (self->hooks.poll != NULL) "
            f"&& self->hooks.poll(self->hooks.context, {self.literals[port.key]}, value);",
            "}",
        ]

    def _writer(self, port: ExternalPort) -> list[str]:
        place, name = self.places[port.key], self.prefix
        return [
            f"static void {self.functions[port.key]}(void *device, const void *value)",
            "{",
            f"    {name}_instance *const self = device;",
            f"    actuate_output(self, {self.literals[port.key]}, value, &self->outputs.{place}, "
            f"sizeof self->outputs.{place});",
            "}",
        ]

    @property
    def connect(self) -> str:
        """The function that builds the network with these functions behind its ports."""
        drivers = [
            (f".{self.types.field(group)}", self._drivers(ports))
            for group, ports in port_groups(self.network.external_ports)
        ]
        rows = [f"static void connect({self.prefix}_instance *self)", "{"]
        table = Aggregate(tuple(drivers) or ((None, code("0")),))
        rows += lines([define("const struct network_drivers", "drivers", table)], 1)
        given = ", self->hooks.parameters" if self.network.parameters else ""
        rows += [f"    network_initialize(&self->network, &drivers, &self->kernel_hooks{given});", "}"]
        return "\n".join(rows)

    def _drivers(self, ports: Sequence[ExternalPort]) -> Code:
        entries = [self._driver(port) for port in ports]
        return entries[0] if ports[0].index is None else Aggregate(tuple((None, entry) for entry in entries))

    def _driver(self, port: ExternalPort) -> Code:
        if port.medium == "event":
            polled = conditional(
                infix("!=", EQUALITY, code("self->hooks.poll"), code("NULL")),
                code(self.functions[port.key]),
                code("NULL"),
            )
            return Aggregate(((".device", code("self")), (".read", polled)))
        verb = "write" if port.direction == "out" else "read"
        return Aggregate(((".device", code("self")), (f".{verb}", code(self.functions[port.key]))))


def interface_files(
    interface: Interface,
    files: Mapping[str, str],
    headers: Mapping[str, str],
    render: Render,
) -> dict[str, str]:
    """The header and the source; ``files`` identify the program, ``headers`` are all headers of package and kernel,
    by path.
    """
    processes = _number("network_process_count = ", files["network_names.c"])
    first = interface.text((Extent(0, 1), Extent(0, 1)), "", processes)
    own_header = f"{first.name}_api.h"
    texts = {**headers, own_header: render("api.h.j2", api=first), f"{first.name}_api.c": first.instance}
    constants = {"CSP_LEVELS": _number("#define CSP_LEVELS ", files["csp_config.h"]), "CSP_DEEPEST": DEEPEST}
    layout = Layout(texts, constants)
    instance = f"{first.name}_instance"
    build = crc32("\0".join(text for _, text in sorted(files.items())).encode())
    extents = layout.extent(instance), layout.extent(instance, pointer=4)
    api = interface.text(extents, f"{build:08x}", processes)
    classes = {name for name in interface.names.classes.values() if f"{name}.h" in files}
    own = {own_header: render("api.h.j2", api=api), f"{api.name}_api.c": render("api.c.j2", api=api)}
    return {**own, **pointer_files(layout, classes)}


def _number(before: str, text: str) -> int:
    """The number after a text of a generated file."""
    found = re.search(rf"{re.escape(before)}(\d+)U", text)
    assert found is not None
    return int(found[1])
