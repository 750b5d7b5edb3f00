"""The names of files by hand in a package: those that are taken, and headers with the names of definitions."""

from __future__ import annotations

import posixpath
from collections.abc import Collection, Iterable, Iterator, Mapping

from cspdiag.base.record import record
from cspdiag.codegen.c.laws.external import included_paths, source_paths
from cspdiag.codegen.c.text.names import FILES, PUBLIC_HEADERS, PackageNames, snake_case
from cspdiag.codegen.c.text.reserved import is_header_of_c
from cspdiag.codegen.shared.target_error import TargetError
from cspdiag.network.ir.equations import ExternalBody
from cspdiag.network.ir.external import external_calls
from cspdiag.network.ir.network import Environment, Network, ProcessClass

_ENDINGS = (".c", ".h")
_UNUSED = frozenset(("main", "port", "exceptions", "environment", "fmu", "values"))
"""Of the names that no class may have, those that no file of a package has."""
_STRUCTS = frozenset(("network", "network_drivers"))
"""Those that are generated, besides those of classes, of types and of the interface."""


@record
class DefinitionInC:
    """A definition with a body in C."""

    name: str
    body: ExternalBody
    is_driver: bool = False

    @property
    def struct(self) -> str:
        """The name of its struct."""
        return snake_case(self.name)

    @property
    def file(self) -> str:
        """The stem of the header that generated code includes for it; that of a driver may have any name."""
        return "" if self.is_driver else self.struct


def refuse_taken_names(
    definitions: Iterable[DefinitionInC],
    network: Network,
    names: PackageNames,
    texts: Mapping[str, str],
    kernel: Collection[str],
) -> None:
    """Raises TargetError for each file by hand, and each definition, that needs the name of a generated file or type,
    of a file of the ``kernel``, or of a header of C, which it would hide. Some file systems ignore capitals.
    """
    taken = {name.lower(): "the name of a generated file" for name in _generated(network, names)}
    taken |= {name.lower(): "the name of a file of the kernel" for name in kernel}
    structs = _STRUCTS | names.interface.union(names.types.values())
    found: dict[str, None] = {}
    for item in definitions:
        if item.struct in structs:
            what = f"the struct of `{item.name}` would be `{item.struct}`, the name of a generated type"
            found[f"{item.body.span}: {what}\n  help: rename `{item.name}`"] = None
            continue
        paths = list(_reached(source_paths(item.body), texts))
        given = {posixpath.basename(path) for path in paths}
        for path in paths:
            name = posixpath.basename(path)
            if reason := _reason(name, taken):
                others = f" and `{item.name}`" if posixpath.splitext(name)[0] == item.file else ""
                found[f"{item.body.span}: {name}, written by hand, has {reason}\n  help: rename it{others}"] = None
        needed = f"{item.file}.h"
        if item.file and needed not in given:
            what = f"{item.body.span}: {needed}, which has the struct of `{item.name}`, has"
            if reason := _reason(needed, taken):
                found[f"{what} {reason}\n  help: rename `{item.name}`"] = None
            for name in given:
                if name.lower() == needed.lower():
                    found[f"{what} the name of {name}, but for capitals\n  help: rename that to {needed}"] = None
    if found:
        raise TargetError("\n".join(found))


def headers_of_definitions(definitions: Iterable[DefinitionInC], by_hand: Collection[str]) -> dict[str, str]:
    """A header with the name of each law and each process whose header by hand has another name."""
    headers: dict[str, str] = {}
    for item in definitions:
        if item.file and f"{item.file}.h" not in by_hand:
            header = posixpath.basename(source_paths(item.body)[1])
            headers[f"{item.file}.h"] = f'/* `{item.name}` is written by hand. */\n#include "{header}"\n'
    return headers


def definitions_in_c(network: Network, environments: Iterable[Environment]) -> Iterator[DefinitionInC]:
    """What the network has of definitions by hand."""
    for class_ in network.classes:
        if class_.external is not None and class_.external.language == "c":
            yield DefinitionInC(class_.definition, class_.external)
    for owner in (*network.classes, *environments):
        for call in external_calls(owner):
            if call.external.language == "c":
                yield DefinitionInC(call.definition, call.external)
    for environment in environments:
        for driver in environment.drivers:
            if driver.external.language == "c":
                yield DefinitionInC(driver.definition, driver.external, is_driver=True)


def _generated(network: Network, names: PackageNames) -> Iterator[str]:
    stems = [name for name in FILES if name not in _UNUSED]
    stems += [f"{names.prefix}_{part}" for part in PUBLIC_HEADERS]
    for class_ in network.classes:
        if class_.external is None:
            stems.append(names.classes[class_.name])
        elif isinstance(class_, ProcessClass):
            stems.append(f"{names.classes[class_.name]}_ports")
    stems += names.environments.values()
    yield from (f"{stem}{ending}" for stem in stems for ending in _ENDINGS)


def _reached(paths: Iterable[str], texts: Mapping[str, str]) -> Iterator[str]:
    """The files, and those beside them that they include."""
    found = dict.fromkeys(paths)
    pending = list(found)
    while pending:
        path = pending.pop()
        for included in included_paths(path, texts.get(path, "")):
            if included in texts and included not in found:
                found[included] = None
                pending.append(included)
    yield from found


def _reason(name: str, taken: Mapping[str, str]) -> str:
    """Whose name it is; empty if it is free."""
    stem, ending = posixpath.splitext(name)
    if ending == ".h" and is_header_of_c(stem):
        return "the name of a header of C or of a compiler, which would not be found"
    return taken.get(name.lower(), "")
