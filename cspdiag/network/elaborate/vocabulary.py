"""The vocabulary of a network: the constants, enums, structs and exceptions that it uses."""

from __future__ import annotations

from collections.abc import Iterable

from cspdiag.base.record import ATOMS, annotations_of, field_names, is_record
from cspdiag.base.span import Span
from cspdiag.model.program import Program
from cspdiag.model.types import UNKNOWN, EnumType, StructType
from cspdiag.network.ir.expressions import LiteralValue
from cspdiag.network.ir.network import ConstantEnd, InstanceOf, NamedConstant
from cspdiag.syntax import ast


class Vocabulary:
    """The named constants and types that occur in the given parts of a network."""

    def __init__(self, program: Program, parts: Iterable[object]) -> None:
        self.program = program
        self._constants: set[str] = set()
        self._types: dict[EnumType | StructType, None] = {}
        self._look(parts)

    def constants(self) -> tuple[NamedConstant, ...]:
        """The constants of the text that some expression uses, in text order."""
        found = []
        for definition in self.program.definitions.values():
            if isinstance(definition, ast.Constant) and definition.name.text in self._constants:
                value = self.program.constants.get(definition)
                if value is not None:
                    found.append(
                        NamedConstant(
                            name=definition.name.text,
                            doc=definition.doc,
                            span=definition.name.span,
                            type=self.program.types.get(definition, UNKNOWN),
                            value=value,
                        )
                    )
        return tuple(found)

    def enums(self) -> tuple[EnumType, ...]:
        """The enums that occur."""
        return tuple(kind for kind in self._types if isinstance(kind, EnumType))

    def structs(self) -> tuple[StructType, ...]:
        """The structs that occur, each after those of its fields."""
        order: dict[StructType, None] = {}

        def add(kind: StructType) -> None:
            for _, inner in kind.fields:
                if isinstance(inner, StructType):
                    add(inner)
            order[kind] = None

        for kind in self._types:
            if isinstance(kind, StructType):
                add(kind)
        return tuple(order)

    def exceptions(self) -> tuple[str, ...]:
        """The exceptions that the text declares, in text order."""
        definitions = self.program.definitions.values()
        return tuple(d.name.text for d in definitions if isinstance(d, ast.ExceptionDefinition))

    def _look(self, parts: Iterable[object]) -> None:
        pending: list[object] = list(parts)
        pending.reverse()
        met: set[int] = set()
        inside: dict[type, tuple[str, ...]] = {}
        while pending:
            item = pending.pop()
            if isinstance(item, tuple):
                pending.extend(reversed(item))
                continue
            if isinstance(item, InstanceOf):
                # Of what its ports are attached to only a default has a value, and a network has many instances.
                attached = (connection.attachment for connection in reversed(item.connections))
                pending += [end for end in attached if isinstance(end, ConstantEnd)]
                pending.append(item.arguments)
                continue
            names = inside.get(type(item))
            if names is None:
                names = inside[type(item)] = _names_inside(item)
            if names and id(item) not in met:
                met.add(id(item))
                if isinstance(item, LiteralValue) and item.name is not None:
                    self._constants.add(item.name)
                elif isinstance(item, EnumType | StructType):
                    self._types[item] = None
                pending.extend(inner for name in names if (inner := getattr(item, name)) is not None)


_ATOMS = ATOMS | {"Span", "Span | None"}


def _names_inside(item: object) -> tuple[str, ...]:
    """The fields of a record to search, the last one first, at least one of a record that is sought; none for other
    values.
    """
    if isinstance(item, Span) or not is_record(item):
        return ()
    annotations = annotations_of(type(item))
    names = field_names(item)
    inside = tuple(name for name in reversed(names) if annotations[name] not in _ATOMS)
    is_sought = isinstance(item, LiteralValue | EnumType | StructType)
    return inside or (names[:1] if is_sought else ())
