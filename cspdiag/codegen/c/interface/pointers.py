"""Where the pointers of `struct network` are, for copies of its state without pointers: `network_pointers.c`."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import count

from cspdiag.base.record import record
from cspdiag.codegen.c.interface.layout import Layout
from cspdiag.codegen.c.interface.structures import (
    Array,
    CType,
    Either,
    Function,
    Named,
    NotUnderstood,
    Pointer,
    Structure,
)
from cspdiag.codegen.c.text.code import SUM, Aggregate, Code, call, cast, code, infix, unsigned
from cspdiag.codegen.c.text.documents import comment
from cspdiag.codegen.c.text.statements import Blank, Statement, lines, store
from cspdiag.codegen.shared.target_error import TargetError

FILE = "network_pointers"
_TOP = "struct network"
_HOOKS = ("csp_kernel", "hooks")
"""The pointer that belongs to an instance, whatever is restored into it."""


@record
class _Part:
    """Of ``owner``, a structure with a name: what is at ``path`` in it, seen from ``base``, an element of an array, or
    from its beginning if that is empty. In an array, ``element`` is the path of one of its elements.
    """

    owner: str
    base: str
    path: str
    element: str

    def member(self, name: str) -> _Part:
        """Of a structure; the members of one without a name are those of the one around it."""
        path = f"{self.element}{'.' if self.element else ''}{name}".rstrip(".")
        return _Part(self.owner, self.base, path, path)

    def first(self) -> _Part:
        """An element of an array."""
        return _Part(self.owner, self.base, self.path, f"{self.element}[0]")

    @property
    def is_array(self) -> bool:
        """Whether it has elements."""
        return self.element != self.path

    def offset(self) -> Code:
        """From the base."""
        offset = call("offsetof", self.owner, self.path)
        return infix("-", SUM, offset, call("offsetof", self.owner, self.base)) if self.base else offset

    def count(self) -> Code:
        """Of the elements. Only a compiler knows it: lengths may depend on sizes and on its options."""
        return call("CSP_ELEMENTS", self.owner, self.path, self.element) if self.is_array else unsigned(1)


@record
class _Row:
    """A pointer, or a structure with pointers, whose ``table`` it is; or an array of them."""

    part: _Part
    size: Code
    table: str = ""


class Pointers:
    """The structures in which there are pointers, each after those inside it."""

    def __init__(self, layout: Layout, classes: Iterable[str]) -> None:
        self._layout = layout
        self._classes = sorted(classes)
        self._rows: dict[str, list[_Row]] = {}
        self._depths: dict[str, int] = {}
        self._tables: dict[str, str] = {}
        """By the structure, or by the path of the array of structures without a name."""
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
        for table, rows_of_table in self._rows.items():
            if rows_of_table:
                statements += [*self._written(table, rows_of_table), Blank()]
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

    def _describe(self, type_name: str) -> str:
        """The table of a structure with a name; empty if it has no pointers."""
        type_ = self._known(Named(type_name))
        if not isinstance(type_, Structure):
            return ""
        return self._table(self._layout.known_as(type_name), type_name, _Part(type_name, "", "", ""), type_)

    def _table(self, key: str, name: str, part: _Part, type_: Structure) -> str:
        """The table of the structures that are like ``part``; empty if they have no pointers."""
        if key not in self._tables:
            table = self._tables[key] = FILE if name == _TOP else self._named(name)
            rows = list(self._members(part, type_))
            below = max((self._depths[row.table] for row in rows if row.table), default=0)
            self._rows[table] = rows
            self._depths[table] = below + 1 if rows else 0
        table = self._tables[key]
        return table if self._depths[table] else ""

    def _named(self, name: str) -> str:
        """A name that is free, and so is that of its rows."""
        first = f"pointers_of_{_as_word(name.rpartition(' ')[2])}"
        taken = {taken for table in self._tables.values() for taken in (table, _members_of(table))}
        names = (f"{first}_{number}" if number > 1 else first for number in count(1))
        return next(name for name in names if taken.isdisjoint((name, _members_of(name))))

    def _members(self, around: _Part, type_: Structure) -> Iterator[_Row]:
        """In a union of pointers, the first represents all of them."""
        members = type_.members
        if type_.kind == "union" and all(isinstance(self._known(one.type), Pointer) for one in members):
            members = members[:1]
        for member in members:
            if (around.owner, member.name) == _HOOKS:
                continue
            owner = around.owner
            rows = list(self._member(around.member(member.name), member.type))
            if rows and member.condition:
                raise TargetError(
                    f"{self._layout.path(owner)}:{member.condition}: whether `{owner}` has `{member.name}`, with a "
                    "pointer, depends on the preprocessor\n"
                    "  help: declare it without a condition, so that states can be saved"
                )
            if rows and type_.kind == "union" and len(members) > 1:
                raise TargetError(
                    f"{self._layout.path(owner)}:{member.line}: whether the union in `{owner}` holds the pointer "
                    f"`{rows[0].part.path}` or something else is not known\n"
                    "  help: declare the members one after the other, so that states can be saved"
                )
            yield from rows

    def _known(self, type_: CType) -> CType:
        """The type that a name has in the end; any of those that differ in nothing but lengths."""
        known = self._layout.resolved(type_)
        while isinstance(known, Either) and not known.place:
            known = self._layout.resolved(known.types[0])
        return known

    def _member(self, part: _Part, type_: CType) -> Iterator[_Row]:
        """The rows of a member."""
        known = self._known(type_)
        match known:
            case Pointer():
                yield _Row(part, call("sizeof", "void *"))
            case Array():
                yield from self._member(part.first(), known.element)
            case Either(types=types, place=place):
                if any(map(self._may_point, types)):
                    of = f", of the type `{type_.name}`," if isinstance(type_, Named) else ""
                    raise TargetError(
                        f"{place}: whether `{part.path}` in `{part.owner}`{of} has a pointer is not known: its type is "
                        "defined under a condition, or more than once\n"
                        "  help: define it once, without a condition, so that states can be saved"
                    )
            case Structure() if isinstance(type_, Named):
                if table := self._describe(type_.name):
                    yield _Row(part, call("sizeof", type_.name), table)
            case Structure() if part.is_array:
                inside = _Part(part.owner, part.element, part.element, part.element)
                key, name = f"{part.owner}.{part.element}", f"{part.owner}_{part.element}"
                if table := self._table(key, name, inside, known):
                    yield _Row(part, call("CSP_SIZE_OF", part.owner, part.element), table)
            case Structure():
                yield from self._members(part, known)
            case Named() | Function() | NotUnderstood():  # `resolved` refuses the last; no header defines the first.
                return

    def _may_point(self, type_: CType) -> bool:
        """Whether it may have a pointer."""
        match self._layout.resolved(type_):
            case Pointer():
                return True
            case Array(element=element):
                return self._may_point(element)
            case Structure(members=members):
                return any(self._may_point(member.type) for member in members)
            case Either(types=types):
                return any(map(self._may_point, types))
            case Named() | Function() | NotUnderstood():
                return False

    # ---- Writing them

    def _functions(self) -> Iterator[Statement]:
        names = ["csp_advance", *(f"{name}_initialize" for name in self._classes)]
        entries = tuple((None, cast("csp_function *", code(name))) for name in names)
        yield store("csp_function *const network_functions[CSP_NETWORK_FUNCTIONS]", Aggregate(entries))

    def _written(self, table: str, rows: list[_Row]) -> Iterator[Statement]:
        value = Aggregate(tuple((None, self._row(row)) for row in rows))
        yield store(f"static const csp_pointer_member {_members_of(table)}[]", value)
        storage = "" if table == FILE else "static "
        value = Aggregate(((None, code(_members_of(table))), (None, unsigned(len(rows)))))
        yield store(f"{storage}const csp_pointers {table}", value)

    def _row(self, row: _Row) -> Code:
        inside = code(f"&{row.table}") if row.table else code("NULL")
        return Aggregate(tuple((None, part) for part in (row.part.offset(), row.part.count(), row.size, inside)))


def _as_word(path: str) -> str:
    """Of ``law_w[0].x[0]``: ``law_w_x``."""
    return path.replace("[0]", "").replace(".", "_")


def _members_of(table: str) -> str:
    return f"{table}_members"


def pointer_files(layout: Layout, classes: Iterable[str]) -> dict[str, str]:
    """The header and the source with the tables, and the functions that initialize instances of ``classes``."""
    pointers = Pointers(layout, classes)
    return {f"{FILE}.h": pointers.header(), f"{FILE}.c": pointers.source()}
