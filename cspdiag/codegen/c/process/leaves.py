"""Hand-written processes in C: the header that their files include, and the connections of their ports."""

from __future__ import annotations

import re
from collections.abc import Iterator

from cspdiag.codegen.c.interface.layout import inside_braces, without_comments
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

_TYPE = r"\b(csp_(?:process|ends|in|out))\b(?!\s*\*)"
_MACRO = re.compile(rf"^[ \t]*#[ \t]*define[ \t]+(?P<name>\w+)(?:\\\n|.)*?{_TYPE}", re.MULTILINE)
_HIDDEN = {
    "`typedef`": re.compile(rf"\btypedef\s+{_TYPE}"),
    "struct without a name": re.compile(rf"\btypedef\s+struct\s*\{{[^}}]*{_TYPE}"),
}
"""What hides members of the kernel's types."""
_DIRECTIVE = re.compile(r"^[ \t]*#", re.MULTILINE)


def refuse_hidden_members(class_: ProcessClass, header: str, names: PackageNames) -> None:
    """Raises TargetError if the text of the header does not show all members of the struct of a process: saved states
    have no pointers, so these must be known.
    """
    reasons = list(_hidden_members(names.classes[class_.name], without_comments(header)))
    if reasons:
        listed = "\n".join(f"{leaf_header(class_)}:{line}: {reason}" for line, reason in reasons)
        raise TargetError(f"{listed}\n  help: write each member as in `csp_in level;`, so that states can be saved")


def _hidden_members(struct: str, text: str) -> Iterator[tuple[int, str]]:
    begun = re.search(rf"\bstruct\s+{struct}\s*\{{", text)
    body = inside_braces(text, begun.end()) if begun else ""
    for found in _MACRO.finditer(text):
        if re.search(rf"\b{found['name']}\b", body):
            yield _line(text, found.start(2)), f"a macro hides a member of the type `{found[2]}`"
    for what, pattern in _HIDDEN.items():
        for found in pattern.finditer(text):
            yield _line(text, found.start(1)), f"a {what} hides a member of the type `{found[1]}`"
    directive = _DIRECTIVE.search(body)
    if begun and directive:
        line = _line(text, begun.end() + directive.end())
        yield line, f"what members `struct {struct}` has depends on the preprocessor"


def _line(text: str, at: int) -> int:
    return text.count("\n", 0, at) + 1


def leaf_header(class_: ProcessClass) -> str:
    """The name of the hand-written header, which is next to the file that the program names."""
    assert class_.external is not None
    return f"{class_.external.target.rpartition('/')[2].removesuffix('.c')}.h"


def ports_header(class_: ProcessClass, names: PackageNames, types: CTypes) -> dict[str, str]:
    """`logger_ports.h`, which the hand-written header includes."""
    assert class_.external is not None
    struct, layout = names.classes[class_.name], PortLayout(class_)
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
