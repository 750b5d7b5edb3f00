"""The names of processes, groups and channels, by number, for traces and reports."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from cspdiag.codegen.c.process.processes import ProcessFiles
from cspdiag.codegen.c.text.literals import quoted
from cspdiag.codegen.c.text.media import access_of_channel
from cspdiag.codegen.c.text.types import CTypes
from cspdiag.model.types import Type
from cspdiag.network.ir.network import CreatedInstance, Network, ProcessClass


def names_file(network: Network, types: CTypes, described: Mapping[str, ProcessFiles]) -> str:
    """`network_names.c`: tables in the order in which the initialization functions of processes assign numbers."""
    numbering = _Numbering(network, described)
    processes, channels = numbering.processes, numbering.channels
    sizes = [f"sizeof({types.type_name(type_)})" for _, type_ in channels]
    rows = ['#include "network.h"', '#include "csp_arithmetic.h"', '#include "types.h"', ""]
    rows += ["#if CSP_TRACE || CSP_MEASURE || CSP_TRACE_HOOK"]
    rows += [f"const uint32_t network_channel_count = {len(channels)}U;"]
    rows += _table("const char *const network_channel_names[]", [quoted(name) for name, _ in channels])
    rows += _table("const uint32_t network_channel_sizes[]", sizes or ["0"])
    rows += ["", "/* Numbers of processes and groups count from 1; a group has no kind. */"]
    rows += [f"const uint32_t network_process_count = {len(processes)}U;"]
    rows += _table("const char *const network_process_names[]", ['""', *(quoted(name) for name, _ in processes)])
    rows += _table("const char *const network_process_kinds[]", ['""', *(quoted(kind) for _, kind in processes)])
    rows += ["#else", "typedef int network_has_no_names;", "#endif", ""]
    if numbering.variables:
        rows += ["/* Variables that may be read before they were written. */"]
        rows += [*_table("const char *const network_variable_names[]", [quoted(v) for v in numbering.variables]), ""]
    return "\n".join(rows)


class _Numbering:
    """Walks the tree of instances in the order in which they are initialized."""

    def __init__(self, network: Network, described: Mapping[str, ProcessFiles]) -> None:
        self.classes = {entry.name: entry for entry in network.classes if isinstance(entry, ProcessClass)}
        self.described = described
        self.processes: list[tuple[str, str]] = []
        """Path and name of the definition of each; groups have an empty definition."""
        self.channels: list[tuple[str, Type]] = [
            (f"{network.top}.{port.key}", port.type) for port in network.external_ports
        ]
        self.variables: list[str] = []
        pending = [(network.top, self.classes[network.top])]
        while pending:
            path, class_ = pending.pop()
            self._process(path, class_)
            pending += reversed(list(self._inner(path, class_)))

    def _process(self, path: str, class_: ProcessClass) -> None:
        self.processes.append((path, class_.definition))
        for channel in class_.channels:
            if access_of_channel(channel) != "variable":
                self.channels.append((f"{path}.{channel.name}", channel.type))
        described = self.described.get(class_.name)
        if described is not None:
            self.processes += [(f"{path}.{name}", kind) for name, kind in described.observed]
            self.variables += [f"{path}.{name}" for name in described.variables]
            self.channels += [(f"{path}.{name}", type_) for name, type_ in described.reports]

    def _inner(self, path: str, class_: ProcessClass) -> Iterator[tuple[str, ProcessClass]]:
        instances = {instance.name: instance for instance in class_.instances}
        for item in class_.creation:
            if isinstance(item, CreatedInstance):
                instance = instances[item.instance]
                if instance.class_name in self.classes:
                    yield f"{path}.{instance.name}", self.classes[instance.class_name]


def _table(declaration: str, entries: list[str]) -> list[str]:
    rows = [f"{declaration} = {{", *(f"    {entry}," for entry in entries)]
    return [*(rows if entries else [*rows, "    0"]), "};"]
