"""Hand-written processes in C: the header that their files include, and the connections of their ports."""

from __future__ import annotations

from cspdiag.codegen.c.interface.layout import Layout
from cspdiag.codegen.c.interface.structures import Either, Named, Structure
from cspdiag.codegen.c.process.struct.port_layout import PortLayout
from cspdiag.codegen.c.text.documents import comment
from cspdiag.codegen.c.text.media import Access
from cspdiag.codegen.c.text.names import PackageNames
from cspdiag.codegen.c.text.statements import Block, lines, run, signature
from cspdiag.codegen.c.text.types import CTypes
from cspdiag.codegen.shared.target_error import TargetError
from cspdiag.network.ir.network import ProcessClass

KINDS: dict[Access, str] = {
    "variable": "CSP_END_VARIABLE",
    "constant": "CSP_END_VARIABLE",
    "discard": "CSP_END_VARIABLE",
    "channel": "CSP_END_CHANNEL",
    "guarded": "CSP_END_GUARDED",
    "any": "CSP_END_ANY",
    "broadcast": "CSP_END_BROADCAST",
    "buffer": "CSP_END_BUFFER",
    "sampled": "CSP_END_SAMPLED",
    "event": "CSP_END_EVENT",
    "latched": "CSP_END_LATCHED",
    "direct": "CSP_END_DIRECT",
}
"""The kernel's constants for what a port of such a process is connected to."""

_FIRST = ("process", Named("csp_process"))
"""The member that the kernel takes for the process."""


def require_first_member(class_: ProcessClass, headers: Layout, names: PackageNames) -> None:
    """Raises TargetError if the struct of a process does not begin with what the kernel takes for it."""
    struct = f"struct {names.classes[class_.name]}"
    found = headers.resolved(Named(struct))
    if isinstance(found, Either):  # Whether each begins with the same is seen when its pointers are found.
        found = found.types[0]
    if isinstance(found, Structure) and [(one.name, one.type) for one in found.members[:1]] != [_FIRST]:
        raise TargetError(
            f"{leaf_header(class_)}: `{struct}` does not begin with the process that the kernel runs\n"
            "  help: its first member has to be `csp_process process;`"
        )


def leaf_header(class_: ProcessClass) -> str:
    """The name of the hand-written header, which is next to the file that the program names."""
    assert class_.external is not None
    return f"{class_.external.target.rpartition('/')[2].removesuffix('.c')}.h"


def ports_header(class_: ProcessClass, names: PackageNames, types: CTypes) -> dict[str, str]:
    """`logger_ports.h`, which the hand-written header includes."""
    assert class_.external is not None
    struct, layout = names.classes[class_.name], PortLayout(class_, names.macros)
    guard, place = f"{struct.upper()}_PORTS_H", names.place(class_.span.file, class_.span.line)
    about = [f"What the process {class_.definition}, written by hand in {class_.external.target}, is connected to."]
    rows = [*comment([*about, "", f"Source: {place}"]), f"#ifndef {guard}", f"#define {guard}", ""]
    rows += ['#include "csp.h"', '#include "csp_leaf.h"', '#include "types.h"', "", f"struct {struct};", ""]
    members = tuple(
        run(f"csp_connection {layout.names[port.name]}{'' if port.size is None else f'[{port.size}]'}")
        for port in class_.ports
    )
    given = [f"struct {struct} *self", "csp_numbers *numbers"]
    if members:
        rows += [*lines([Block(members, f"struct {struct}_ports", "};")]), ""]
        given.append(f"const struct {struct}_ports *ports")
    given += [f"{types.type_name(item.type)} {layout.parameters[item.name]}" for item in class_.parameters]
    rows += ["/* To be defined by hand. */", *signature(f"void {struct}_initialize", given, ";")]
    return {f"{struct}_ports.h": "\n".join([*rows, "", "#endif", ""])}
