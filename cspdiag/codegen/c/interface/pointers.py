"""Where the pointers of `struct network` are, for copies of its state without pointers: `network_pointers.c`."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from cspdiag.base.record import record
from cspdiag.codegen.c.interface.layout import Layout, Member, members_of
from cspdiag.codegen.c.text.code import Aggregate, Code, call, cast, code, unsigned
from cspdiag.codegen.c.text.documents import comment
from cspdiag.codegen.c.text.statements import Blank, Statement, lines, store

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
            kind, body = self._layout.definition(type_name)
            rows = list(self._members(type_name, "", kind, body)) if kind in ("struct", "union") else []
            below = max((self._depths[_table(row.type)] for row in rows if row.type), default=0)
            self._rows[table] = rows
            self._depths[table] = below + 1 if rows else 0
        return self._depths[table]

    def _members(self, owner: str, path: str, kind: str, body: str) -> Iterator[_Row]:
        """In a union of pointers, the first represents all of them; other unions are values, which have no pointers."""
        members = list(members_of(body))
        if kind == "union":
            members = members[:1] if all(member.is_pointer for member in members) else []
        for member in members:
            yield from self._member(owner, path, member)

    def _member(self, owner: str, path: str, member: Member) -> Iterator[_Row]:
        inside, whole = f"{path}{member.name}", self._layout.count(member)
        extents = [f"{extent}U" if extent.isdecimal() else extent for extent in member.extents]
        count = " * ".join(extents) if extents else "1U"
        if member.kind:
            places = [inside] if not member.extents else [f"{inside}[{index}]" for index in range(whole)]
            for place in places:
                yield from self._members(owner, f"{place}.", member.kind, member.body)
        elif member.is_pointer and (owner, member.name) != _HOOKS:
            yield _Row(owner, inside, count, "")
        elif not member.is_pointer and self._describe(member.type):
            yield _Row(owner, inside, count, member.type)

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
