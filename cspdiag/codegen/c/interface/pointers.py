"""Where the pointers of `struct network` are, for copies of its state without pointers: `network_pointers.c`."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import prod

from cspdiag.base.record import record
from cspdiag.codegen.c.interface.declarations import Array, CType, Function, Named, NotUnderstood, Pointer, Structure
from cspdiag.codegen.c.interface.layout import Layout
from cspdiag.codegen.c.text.code import Aggregate, Code, call, cast, code, unsigned
from cspdiag.codegen.c.text.documents import comment
from cspdiag.codegen.c.text.statements import Blank, Statement, lines, store
from cspdiag.codegen.shared.target_error import TargetError

FILE = "network_pointers"
_TOP = "struct network"
_HOOKS = ("csp_kernel", "hooks")
"""The pointer that belongs to an instance, whatever is restored into it."""


@record
class _Row:
    """A pointer, or a structure with pointers: a member of ``owner``, which may be an array of ``count``."""

    owner: str
    path: str
    count: str
    type: str
    """Of the structure; empty for a pointer."""


class Pointers:
    """The structures in which there are pointers, each after those inside it."""

    def __init__(self, layout: Layout, classes: Iterable[str]) -> None:
        self._layout = layout
        self._classes = sorted(classes)
        self._rows: dict[str, list[_Row]] = {}
        self._depths: dict[str, int] = {}
        self._describe(_TOP)

    @property
    def depth(self) -> int:
        """How many structures are inside each other at most."""
        return self._depths[FILE]

    def source(self) -> str:
        """The tables."""
        about = "Where the pointers of struct network are, so that copies can be moved."
        rows = [*comment([about]), f'#include "{FILE}.h"', "", '#include "network.h"']
        rows += [*(f'#include "{name}.h"' for name in self._classes), ""]
        statements: list[Statement] = [*self._functions(), Blank()]
        for table, members in self._rows.items():
            if members:
                statements += [*self._tables(table, members), Blank()]
        return "\n".join([*rows, *lines(statements[:-1]), ""])

    def header(self) -> str:
        """The declaration of the table, and how deep it is."""
        guard = f"{FILE.upper()}_H"
        rows = [*comment(["Where the pointers of struct network are."]), f"#ifndef {guard}", f"#define {guard}", ""]
        rows += ['#include "csp_saved.h"', "", "/* How many structures are inside each other at most. */"]
        rows += [f"#define CSP_NETWORK_DEPTH {self.depth}U", f"extern const csp_pointers {FILE};", ""]
        rows += ["/* Some functions of the image: in another one, their distances are different. */"]
        rows += [f"#define CSP_NETWORK_FUNCTIONS {len(self._classes) + 1}U"]
        rows += ["extern csp_function *const network_functions[CSP_NETWORK_FUNCTIONS];"]
        return "\n".join([*rows, "", "#endif", ""])

    # ---- Finding them

    def _describe(self, type_name: str) -> int:
        """The depth of a structure, 0 if it has no pointers."""
        table = _table(type_name)
        if table not in self._depths:
            type_ = self._layout.resolved(Named(type_name))
            rows = list(self._members(type_name, "", type_)) if isinstance(type_, Structure) else []
            below = max((self._depths[_table(row.type)] for row in rows if row.type), default=0)
            self._rows[table] = rows
            self._depths[table] = below + 1 if rows else 0
        return self._depths[table]

    def _members(self, owner: str, path: str, type_: Structure) -> Iterator[_Row]:
        """In a union of pointers, the first represents all of them."""
        members = type_.members
        if type_.kind == "union" and all(isinstance(self._layout.resolved(one.type), Pointer) for one in members):
            members = members[:1]
        for member in members:
            if (owner, member.name) == _HOOKS:
                continue
            rows = list(self._member(owner, f"{path}{member.name}", member.type, ()))
            if rows and member.condition:
                raise TargetError(
                    f"{self._layout.path(owner)}:{member.condition}: whether `{owner}` has `{member.name}`, with a "
                    "pointer, depends on the preprocessor\n"
                    "  help: declare it without a condition, so that states can be saved"
                )
            if rows and type_.kind == "union" and len(members) > 1:
                raise TargetError(
                    f"{self._layout.path(owner)}: whether the union in `{owner}` holds the pointer `{rows[0].path}` or "
                    "something else is not known\n"
                    "  help: declare the members one after the other, so that states can be saved"
                )
            yield from rows

    def _member(self, owner: str, path: str, type_: CType, lengths: tuple[str, ...]) -> Iterator[_Row]:
        """The rows of a member, an array if there are ``lengths``."""
        known = self._layout.resolved(type_)
        count = " * ".join(f"{length}U" if length.isdecimal() else length for length in lengths) or "1U"
        match known:
            case Pointer():
                yield _Row(owner, path, count, "")
            case Array():
                yield from self._member(owner, path, known.element, (*lengths, known.length))
            case Structure() if isinstance(type_, Named):
                if self._describe(type_.name):
                    yield _Row(owner, path, count, type_.name)
            case Structure():
                whole = prod(self._layout.count(path, length) for length in lengths)
                for place in [f"{path}[{index}]" for index in range(whole)] if lengths else [path]:
                    # Of a structure without a name the members are those of the one around it.
                    inside = place if not place or place.endswith(".") else f"{place}."
                    yield from self._members(owner, inside, known)
            case Named() | Function() | NotUnderstood():  # `resolved` refuses the last; no header defines the first.
                return

    # ---- Writing them

    def _functions(self) -> Iterator[Statement]:
        names = ["csp_advance", *(f"{name}_initialize" for name in self._classes)]
        entries = tuple((None, cast("csp_function *", code(name))) for name in names)
        yield store("csp_function *const network_functions[CSP_NETWORK_FUNCTIONS]", Aggregate(entries))

    def _tables(self, table: str, members: list[_Row]) -> Iterator[Statement]:
        rows = Aggregate(tuple((None, self._row(row)) for row in members))
        yield store(f"static const csp_pointer_member {table}_members[]", rows)
        storage = "" if table == FILE else "static "
        value = Aggregate(((None, code(f"{table}_members")), (None, unsigned(len(members)))))
        yield store(f"{storage}const csp_pointers {table}", value)

    def _row(self, row: _Row) -> Code:
        stride = call("sizeof", row.type or "void *")
        inside = code(f"&{_table(row.type)}") if row.type else code("NULL")
        parts = [call("offsetof", row.owner, row.path), code(row.count), stride, inside]
        return Aggregate(tuple((None, part) for part in parts))


def _table(type_name: str) -> str:
    return FILE if type_name == _TOP else f"pointers_of_{type_name.rpartition(' ')[2]}"


def pointer_files(layout: Layout, classes: Iterable[str]) -> dict[str, str]:
    """The header and the source with the tables, and the functions that initialize instances of ``classes``."""
    pointers = Pointers(layout, classes)
    return {f"{FILE}.h": pointers.header(), f"{FILE}.c": pointers.source()}
