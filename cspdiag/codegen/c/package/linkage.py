"""`csp_names.h`: what a linker would confuse with the names of another program begins with the name of the package."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from cspdiag.base.record import record
from cspdiag.codegen.c.text.documents import comment, wrapped
from cspdiag.network.lower.distinct_names import DistinctNames

NAMES = "support/csp_names.h"
"""The header, which `csp_config.h` includes before anything is declared."""

NO_NAMES = "/* The only program of its image: names stay as they are. */\n"
"""The header for programs that are linked by themselves, whose kernels can then share their objects."""

_NOT_CODE = re.compile(
    r"/\*.*?\*/|//[^\n]*|\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])*'|__attribute__\s*\(\([^)]*(?:\([^)]*\)[^)]*)*\)\)",
    re.DOTALL,
)
_NAMES_IN_TABLE = re.compile(r"^ *\"[^\"\\\n]*\",\n", re.MULTILINE)
"""Strings that are lines by themselves, which tables of large programs have many of."""
_DIRECTIVE = re.compile(r"^[ \t]*#(?:\\\n|[^\n])*$|^[A-Z][A-Z0-9_]*\(.*\);?$", re.MULTILINE)
"""Directives, and macros that are expanded to declarations."""
_MACRO = re.compile(r"^[ \t]*#[ \t]*define[ \t]+(\w+)", re.MULTILINE)
_INTERNAL = re.compile(r"\b(?:static|typedef)\b")
_FUNCTION = re.compile(r"\b(\w+)\s*\(")
_TYPE_ONLY = re.compile(r"(?:struct|union|enum)\b[\s\w]*(?:\{\})?")


@record
class _Declaration:
    """What is declared in a source or a header; functions with a body end in ``{}``, and so do definitions of types."""

    text: str

    @property
    def names(self) -> Iterator[str]:
        """The names with external linkage."""
        text = self.text.partition("=")[0].strip()
        if not text or _INTERNAL.search(text) or _TYPE_ONLY.fullmatch(text):
            return
        function = _FUNCTION.search(text)
        if function is not None:
            yield function[1]
            return
        for declarator in text.replace("{}", "").split(","):
            words = re.findall(r"\w+", declarator.partition("[")[0])
            yield from words[-1:]

    @property
    def is_definition(self) -> bool:
        """Whether it defines a function or an object."""
        if self.text.endswith("{}"):
            return True
        return "=" in self.text or not (re.match(r"\s*extern\b", self.text) or _FUNCTION.search(self.text))


def _declarations(text: str) -> Iterator[_Declaration]:
    """What is declared outside of functions, without bodies and initializers."""
    depth, begun = 0, ""
    for part in re.findall(r"[{};]|[^{};]+", _DIRECTIVE.sub("", _NOT_CODE.sub(" ", text))):
        if part == "{":
            depth += 1
            begun += "{" if depth == 1 else ""
        elif part == "}":
            depth -= 1
            begun += "}" if depth == 0 else ""
            if depth == 0 and re.search(r"\)\s*\{\}$", begun) and "=" not in begun:
                yield _Declaration(begun.strip())
                begun = ""
        elif depth == 0 and part == ";":
            yield _Declaration(begun.strip())
            begun = ""
        elif depth == 0:
            begun += part


def _external(sources: Iterable[str], headers: Iterable[str]) -> set[str]:
    """The names that sources define and that headers of ours declare."""
    found = {name for text in sources for one in _declarations(text) if one.is_definition for name in one.names}
    return found | {name for text in headers for one in _declarations(text) for name in one.names}


def names_header(package: str, sources: Iterable[str], headers: Iterable[str]) -> str:
    """The header, for what ``sources`` define and the ``headers`` of the kernel declare; no new name is in use there
    (``static void connect_motor(void)`` of a package called ``connect``).
    """
    prefix, declaring = f"{package}_", list(headers)
    texts = [_NAMES_IN_TABLE.sub("", text) for text in sources]
    macros = {name for text in (*texts, *declaring) for name in _MACRO.findall(text)}
    external = _external(texts, declaring) - {"main"}
    kept = {name for name in external if name.startswith(prefix)}
    own = re.compile(rf"\b{prefix}\w+")
    distinct = DistinctNames(name for text in (*texts, *declaring) for name in own.findall(text))
    new = {name: _fresh(f"{prefix}{name}", distinct) for name in sorted(external - kept)}
    about = f"To the linker, names begin with {prefix}: programs with kernels of their own then fit in one image."
    licence = "/* SPDX-License-Identifier: 0BSD */"
    rows = [licence, *comment(wrapped(about)), "#ifndef CSP_NAMES_H", "#define CSP_NAMES_H", ""]
    rows += [f"#define {name} {long}" for name, long in new.items() if name not in macros]
    rows += ["", "#if CSP_TRACE /* otherwise these are macros */"]
    rows += [f"#define {name} {long}" for name, long in new.items() if name in macros and name.islower()]
    return "\n".join([*rows, "#endif", "", "#endif", ""])


def _fresh(wanted: str, distinct: DistinctNames) -> str:
    return distinct.fresh(wanted, lambda count: f"{wanted}_{count}")


def first_included(path: str, text: str) -> str:
    """A source that is written by hand, with these names; its lines keep their numbers."""
    return f'#include "csp_config.h"\n#line 1 "{path}"\n{text}'
