"""Immutable records that cost nothing to define.

``dataclasses`` compiles three functions for every frozen class: 0.4 ms each, 80 ms over the classes of this package,
most of the time that ``cspdiag check`` may take. ``record`` and ``node`` declare fields in the same way and look the same
to a type checker, but share their methods.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, dataclass_transform, overload

T = TypeVar("T")


class _Shared:
    __record_fields__: tuple[str, ...] = ()
    __record_required__: frozenset[str] = frozenset()
    __record_compared__: tuple[str, ...] = ()

    def __init__(self, *positional: Any, **values: Any) -> None:
        if positional:
            values.update(zip(self.__record_fields__, positional, strict=False))
        if not self.__record_required__ <= values.keys() or len(values) > len(self.__record_fields__):
            expected, given = ", ".join(self.__record_fields__), ", ".join(values)
            raise TypeError(f"{type(self).__name__} takes the fields {expected}; given: {given}")
        self.__dict__.update(values)

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"{type(self).__name__}.{name} cannot be set: records do not change")

    def __repr__(self) -> str:
        shown = ", ".join(f"{name}={getattr(self, name)!r}" for name in self.__record_fields__ if name != "span")
        return f"{type(self).__name__}({shown})"


def _equal(self: Any, other: object) -> bool:
    compared: tuple[str, ...] = self.__record_compared__
    if type(self) is not type(other):
        return False
    return all(getattr(self, name) == getattr(other, name) for name in compared)


def _hash(self: Any) -> int:
    # Kept, because a record may hold a whole program, and is looked up again and again.
    kept: dict[str, Any] = self.__dict__
    known: int | None = kept.get("__record_hash__")
    if known is None:
        known = kept["__record_hash__"] = hash(
            (type(self), *(getattr(self, name) for name in self.__record_compared__))
        )
    return known


def _prepare(cls: type[T]) -> None:
    inherited: tuple[str, ...] = getattr(cls, "__record_fields__", ())
    own = tuple(
        name for name, kind in cls.__annotations__.items() if name not in inherited and not kind.startswith("ClassVar")
    )
    names = inherited + own
    cls.__record_fields__ = names  # type: ignore[attr-defined]
    cls.__record_required__ = frozenset(name for name in names if not hasattr(cls, name))  # type: ignore[attr-defined]
    uncompared: frozenset[str] = getattr(cls, "uncompared", frozenset())
    cls.__record_compared__ = tuple(  # type: ignore[attr-defined]
        name for name in names if name != "span" and name not in uncompared
    )
    cls.__match_args__ = names  # type: ignore[attr-defined,misc]
    for method in ("__init__", "__setattr__", "__repr__"):
        if getattr(cls, method) is getattr(object, method):
            setattr(cls, method, getattr(_Shared, method))


@dataclass_transform(frozen_default=True, eq_default=False, kw_only_default=True)
def node(cls: type[T]) -> type[T]:
    """A record that compares and hashes by identity; its fields are given by name.

    Annotations must be strings (``from __future__ import annotations``). Raises TypeError when fields
    are missing or unknown.
    """
    _prepare(cls)
    return cls


@overload
def record(cls: type[T]) -> type[T]: ...
@overload
def record(*, kw_only: bool) -> Callable[[type[T]], type[T]]: ...
@dataclass_transform(frozen_default=True)
def record(cls: type[T] | None = None, *, kw_only: bool = False) -> type[T] | Callable[[type[T]], type[T]]:
    """A record that compares and hashes by value, its ``span`` (and the fields named in ``uncompared``) left out.

    ``kw_only`` concerns type checkers only: fields without a default may then follow fields with one.
    """
    if cls is None:
        return record
    _prepare(cls)
    cls.__eq__ = _equal  # type: ignore[method-assign]
    cls.__hash__ = _hash  # type: ignore[method-assign]
    return cls


def field_names(item: object) -> tuple[str, ...]:
    """The names of a record's fields, in order."""
    return item.__record_fields__  # type: ignore[attr-defined,no-any-return]


def is_record(item: object) -> bool:
    """Whether ``item`` is a node or a record."""
    return hasattr(type(item), "__record_fields__")


def replaced(item: T, **changes: Any) -> T:
    """A copy of a record with some fields changed."""
    values = {name: getattr(item, name) for name in field_names(item)}
    values.update(changes)
    return type(item)(**values)
