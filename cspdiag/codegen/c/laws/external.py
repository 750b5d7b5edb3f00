"""Hand-written bodies in C: pairs of files with the same interface as generated ones, copied into the package."""

from __future__ import annotations

import posixpath
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping

from cspdiag.base import SourceFile
from cspdiag.base.record import replaced
from cspdiag.codegen.c.interface.directives import included_in, may_be_included_twice
from cspdiag.codegen.shared.names import as_one_word
from cspdiag.codegen.shared.target_error import TargetError
from cspdiag.network.ir.equations import ExternalBody
from cspdiag.network.ir.external import external_bodies, files_of_body
from cspdiag.network.ir.network import Environment, Network


def c_bodies(network: Network) -> Iterator[ExternalBody]:
    """The bodies in C that a network uses, each once."""
    yield from dict.fromkeys(
        body for body in external_bodies(network.classes, network.environments) if body.language == "c"
    )


def source_paths(body: ExternalBody) -> tuple[str, str]:
    """The paths of the source and the header of a body, relative like the path in the text."""
    source, header = files_of_body(body)
    return source, header


def header_of(body: ExternalBody) -> str:
    """The name of the header of a body in the package."""
    return posixpath.basename(source_paths(body)[1])


def external_texts(network: Network, read: Callable[[str], SourceFile]) -> dict[str, str]:
    """The texts of all hand-written files that a network needs, by path: sources and headers of bodies, and headers
    beside them that these include. Raises OSError if a source or a header of a body cannot be read, TargetError if
    one of the others is not beside.
    """
    found = {path: read(path).text for body in c_bodies(network) for path in source_paths(body)}
    pending = list(found)
    while pending:
        path = pending.pop()
        for included in included_paths(path, found[path]):
            if included in found:
                continue
            try:
                text = read(included).text
            except OSError:  # It is generated, belongs to the kernel, or is found by the compiler.
                continue
            if posixpath.dirname(included) != posixpath.dirname(path):
                raise TargetError(
                    f"{path} includes {included}, which is in another folder, and would not be found in the package\n"
                    "  help: put it beside the file that includes it"
                )
            found[included] = text
            pending.append(included)
    return found


def included_paths(path: str, text: str) -> Iterator[str]:
    """The paths of what a file includes."""
    return (posixpath.join(posixpath.dirname(path), posixpath.normpath(name)) for name in included_in(text))


def external_files(network: Network, texts: Mapping[str, str]) -> dict[str, str]:
    """The copies of processes and control laws in the package, by file name.

    Raises TargetError if two files have the same name, and for a header that cannot be included twice.
    """
    laws = [replaced(environment, drivers=()) for environment in network.environments]
    copies = _copies(external_bodies(network.classes, laws), texts)
    for name, text in copies.items():
        if name.endswith(".h") and not may_be_included_twice(text):
            guard = as_one_word(name).upper()
            raise TargetError(
                f"{name} has no include guard, and several files of the package include it\n"
                f"  help: begin it with `#ifndef {guard}` and `#define {guard}`, and end it with `#endif`"
            )
    return copies


def device_files(environments: Iterable[Environment], texts: Mapping[str, str]) -> dict[str, str]:
    """The copies of drivers; they belong to environments, not to the program."""
    return _copies((driver.external for entry in environments for driver in entry.drivers), texts)


def _copies(bodies: Iterable[ExternalBody], texts: Mapping[str, str]) -> dict[str, str]:
    found: dict[str, str] = {}
    pending = deque(path for body in bodies if body.language == "c" for path in source_paths(body))
    copied: set[str] = set()
    while pending:
        path = pending.popleft()
        if path in copied:
            continue
        copied.add(path)
        pending += (included for included in included_paths(path, texts.get(path, "")) if included in texts)
        name = posixpath.basename(path)
        if found.setdefault(name, path) != path:
            raise TargetError(f"{found[name]} and {path} would both be {name} in the package: rename one of them")
    return {name: texts[path] for name, path in found.items() if path in texts}
