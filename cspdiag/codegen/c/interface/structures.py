"""Types of C, as headers declare them (ISO C11, 6.7)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import ClassVar

from cspdiag.base.record import record, replaced

_LINES = frozenset({"line"})
Key = tuple[str, int]
"""A name, and how many members before it have the same one, which is none."""


@record
class Named:
    """A type with a name, as it is written without qualifiers: ``struct filter``, ``unsigned long``."""

    name: str


@record
class Pointer:
    """To whatever, also to a function."""


@record
class Function:
    """What only pointers and declarations refer to."""


@record
class Array:
    """Elements, as many as an expression says."""

    element: CType
    length: str


@record
class Structure:
    """A structure or a union. ``alignment``: expressions that ask for one, besides that of the members."""

    kind: str
    members: tuple[Member, ...]
    alignment: tuple[str, ...] = ()


@record
class NotUnderstood:
    """What is written in a way that is not known here; ``part`` is its text."""

    part: str
    line: int = 0

    uncompared: ClassVar[frozenset[str]] = _LINES


@record
class Either:
    """One of some types; which one, the preprocessor decides at ``place``. Without a place they differ in nothing but
    alignments and lengths.
    """

    types: tuple[CType, ...]
    place: str

    uncompared: ClassVar[frozenset[str]] = frozenset({"place"})


CType = Named | Pointer | Function | Array | Structure | NotUnderstood | Either


@record
class Member:
    """A member of a structure; a structure or a union inside, or a bit-field, may have no ``name``. ``condition``: the
    line on which the preprocessor decides about it, 0 if it does not.
    """

    name: str
    type: CType
    alignment: tuple[str, ...] = ()
    condition: int = 0
    line: int = 0

    uncompared: ClassVar[frozenset[str]] = _LINES


def either(types: Iterable[CType], place: str) -> CType:
    """One of some types. If there is no place, because the preprocessor decides nothing else, the only one as it is."""
    flat: dict[CType, None] = {}
    inner = ""
    for type_ in types:
        flat |= dict.fromkeys(type_.types if isinstance(type_, Either) else (type_,))
        inner = inner or (type_.place if isinstance(type_, Either) else "")
    place = inner or place
    return next(iter(flat)) if len(flat) == 1 and not place else Either(tuple(flat), place)


def merged(readings: Sequence[Sequence[Member]], places: Mapping[Key, str]) -> tuple[Member, ...]:
    """The members in all readings of a declaration; ``places`` say where it is decided whether they are there, and as
    what.
    """
    numbered = [_numbered(reading) for reading in readings]
    members = []
    for key, first in {key: member for reading in reversed(numbered) for key, member in reading.items()}.items():
        found = [reading[key] for reading in numbered if key in reading]
        alignment = tuple(dict.fromkeys(text for member in found for text in member.alignment))
        type_ = either([member.type for member in found], places.get(key, ""))
        members.append(replaced(first, type=type_, alignment=alignment))
    return tuple(members)


def _numbered(members: Sequence[Member]) -> dict[Key, Member]:
    """By name, which several members without one share."""
    found: dict[Key, Member] = {}
    for member in members:
        number = sum(name == member.name for name, _ in found)
        found[member.name, number] = member
    return found


def _shape(type_: CType) -> CType:
    match type_:
        case Array(element=element):
            return Array(_shape(element), "")
        case Structure(kind=kind, members=members):
            return Structure(kind, tuple(map(_member_shape, members)))
        case Either(types=types, place=place):
            return Either(tuple(map(_shape, types)), place)
        case _:  # Nothing else contains a length.
            return type_


def types_alike(types: Mapping[str, CType]) -> Mapping[Key, object]:
    """Types by name, without their alignments and lengths."""
    return {(name, 0): _shape(type_) for name, type_ in types.items()}


def members_alike(members: Sequence[Member]) -> Mapping[Key, object]:
    """Members by name, without their alignments and lengths."""
    return {key: _member_shape(member) for key, member in _numbered(members).items()}


def _member_shape(member: Member) -> Member:
    return replaced(member, type=_shape(member.type), alignment=())
