"""The names of processes, groups and channels, by number, for traces and reports."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from cspdiag.base.record import record
from cspdiag.codegen.c.process.processes import ProcessFiles
from cspdiag.codegen.c.text.literals import quoted
from cspdiag.codegen.c.text.media import access_of
from cspdiag.codegen.c.text.types import CTypes
from cspdiag.model.types import Type
from cspdiag.network.elaborate.fewer.continued import continued
from cspdiag.network.ir.network import CreatedInstance, Network, ProcessClass


def names_file(network: Network, types: CTypes, described: Mapping[str, ProcessFiles]) -> str:
    """`network_names.c`: tables in the order in which the initialization functions of processes assign numbers."""
    tables = _tables(network, types, described)
    rows = ['#include "network.h"', '#include "csp_arithmetic.h"', '#include "types.h"', ""]
    rows += ["#if CSP_TRACE || CSP_MEASURE || CSP_TRACE_HOOK"]
    rows += [f"const uint32_t network_channel_count = {len(tables.channels)}U;"]
    rows += _table("const char *const network_channel_names[]", tables.channels)
    rows += _table("const uint32_t network_channel_sizes[]", tables.sizes or [_row("0")])
    rows += ["", "/* Numbers of processes and groups count from 1; a group has no kind. */"]
    rows += [f"const uint32_t network_process_count = {len(tables.processes)}U;"]
    rows += _table("const char *const network_process_names[]", [_NONE, *tables.processes])
    rows += _table("const char *const network_process_kinds[]", [_NONE, *tables.kinds])
    rows += ["#else", "typedef int network_has_no_names;", "#endif", ""]
    if tables.variables:
        rows += ["/* Variables that may be read before they were written. */"]
        rows += [*_table("const char *const network_variable_names[]", tables.variables), ""]
    return "\n".join(rows)


@record
class _Tables:
    """The rows of the tables."""

    channels: tuple[str, ...]
    sizes: tuple[str, ...]
    processes: tuple[str, ...]
    kinds: tuple[str, ...]
    variables: tuple[str, ...]


def _tables(network: Network, types: CTypes, described: Mapping[str, ProcessFiles]) -> _Tables:
    """The rows, continued from those with fewer elements where a class that grows has only what its rows say."""

    def made(network: Network) -> _Tables:
        numbering = _Numbering(network, described)
        return _Tables(
            channels=tuple([_row(quoted(name)) for name, _ in numbering.channels]),
            sizes=tuple([_row(f"sizeof({types.type_name(type_)})") for _, type_ in numbering.channels]),
            processes=tuple([_row(quoted(name)) for name, _ in numbering.processes]),
            kinds=tuple([_row(quoted(kind)) for _, kind in numbering.processes]),
            variables=tuple([_row(quoted(name)) for name in numbering.variables]),
        )

    few = () if network.continued is None else network.continued.few.classes
    growing = [described.get(one.name) for one, other in zip(few, network.classes, strict=False) if one != other]
    if any(found and (found.observed or found.reports or found.variables) for found in growing):
        return made(network)
    return continued(made)(network)


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
            if access_of(channel) != "variable":
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


def _row(entry: str) -> str:
    return f"    {entry},"


_NONE = _row('""')


def _table(declaration: str, rows: Sequence[str]) -> list[str]:
    return [f"{declaration} = {{", *(rows or ["    0"]), "};"]
