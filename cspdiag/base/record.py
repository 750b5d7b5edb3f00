"""Immutable records that cost nothing to define.

``dataclasses`` compiles three functions for every frozen class: 0.4 ms each, 80 ms over the classes of this package,
most of the time that ``cspdiag check`` may take. ``record`` and ``node`` declare fields in the same way and look the
same to a type checker, but share their methods. Plain data is a record; only the runtime, which stands alone, has
dataclasses for it.
"""

from __future__ import annotations

from collections import OrderedDict, deque
from collections.abc import Callable, Mapping
from functools import partial, wraps
from itertools import repeat
from operator import attrgetter, call
from types import FunctionType, MappingProxyType
from typing import Any, ClassVar, Final, Generic, TypeAlias, TypeVar, dataclass_transform, overload

T = TypeVar("T")
Result = TypeVar("Result")
Constructor: TypeAlias = "Callable[..., None]"

EMPTY: Final[Mapping[Any, Any]] = MappingProxyType({})
"""The default of a field that is a mapping."""

_PLACE = frozenset({"span"})


class lazily(Generic[T]):  # noqa: N801 - a decorator, like ``property``
    """A property of a record that is computed when it is first asked for: ``functools.cached_property`` without its
    lock, which takes longer than joining a few texts.
    """

    def __init__(self, compute: Callable[[Any], T]) -> None:
        self._compute = compute
        self._name = compute.__name__
        self.__doc__ = compute.__doc__

    @overload
    def __get__(self, item: None, cls: type) -> lazily[T]: ...
    @overload
    def __get__(self, item: object, cls: type) -> T: ...
    def __get__(self, item: Any, cls: type) -> lazily[T] | T:
        if item is None:
            return self
        value: T
        value = item.__dict__[self._name] = self._compute(item)
        return value


class _Shared:
    __record_fields__: tuple[str, ...] = ()

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"{type(self).__name__}.{name} cannot be set: records do not change")

    def __delattr__(self, name: str) -> None:
        raise AttributeError(f"{type(self).__name__}.{name} cannot be deleted: records do not change")

    def __repr__(self) -> str:
        shown = ", ".join(f"{name}={getattr(self, name)!r}" for name in self.__record_fields__ if name != "span")
        return f"{type(self).__name__}({shown})"


class Slotted:
    """The base of records that are made by the hundred thousand: they have no dictionary, so they take half of the
    memory, and a field is read in a third of the time. Nothing can be computed ``lazily`` in them.

    A class cannot be given slots, so ``node`` and ``record`` make it once more. A metaclass could make it with them at
    once, but then every ``isinstance`` and every pattern with such a class takes some four times as long.
    """

    __slots__ = ()
    __record_defaults__: ClassVar[Mapping[str, Any]] = EMPTY
    __record_stores__: ClassVar[tuple[Callable[[Any, object], None], ...]] = ()


def field_names_of(kind: type) -> tuple[str, ...]:
    """The names of the fields of a class of records, in order; none for other classes."""
    names: tuple[str, ...] = getattr(kind, "__record_fields__", ())
    return names


def _declared_in(annotations: Mapping[str, str]) -> tuple[str, ...]:
    return tuple(name for name, kind in annotations.items() if not kind.startswith("ClassVar"))


def _restored(kind: type[Slotted], values: tuple[object, ...]) -> Slotted:
    """A slotted record with these values, for those that store records."""
    item = kind.__new__(kind)
    _take_all(map(call, kind.__record_stores__, repeat(item), values))
    return item


_take_all = deque[object](maxlen=0).extend


def _stored(self: Any) -> tuple[Callable[..., Any], tuple[type, tuple[object, ...]]]:
    kind = type(self)
    return _restored, (kind, tuple([getattr(self, name) for name in kind.__record_fields__]))


_counts: dict[type, int] = {}
"""How often each class was constructed, until its constructor is replaced by a compiled one."""

_OFTEN = 100
"""After this many constructions, as much time is lost as compiling a constructor takes."""


def _keep(values: dict[str, Any]) -> None:
    self = values.pop("self")
    self.__dict__.update(values)
    _count(type(self))


def _keep_in_slots(values: dict[str, Any]) -> None:
    self = values.pop("self")
    _take_all(map(object.__setattr__, repeat(self), values, values.values()))
    _count(type(self))


def _count(kind: type) -> None:
    count = _counts.get(kind)
    if count is not None:
        _counts[kind] = count + 1
        if count == _OFTEN:
            _compile_constructor(kind)


def _construct(self: Any) -> None:
    _keep(locals())


def _construct_in_slots(self: Any) -> None:
    _keep_in_slots(locals())


def _construct_and_complete(self: Any) -> None:
    _keep(locals())
    self.__post_init__()


def _construct_in_slots_and_complete(self: Any) -> None:
    _keep_in_slots(locals())
    self.__post_init__()


class _InDictionary:
    """How records keep their fields: in the dictionary of each, defaults as attributes of the class.

    The constructors of a class consist of the instructions of ``constructor``, or of ``completing`` if it has a
    ``__post_init__``.
    """

    constructor = staticmethod(_construct)
    completing = staticmethod(_construct_and_complete)

    @staticmethod
    def prepared(cls: Any) -> Any:
        """The class, or the one to use in its place."""
        return cls

    @staticmethod
    def complete(cls: Any) -> None:
        """Give the class what depends on its fields."""

    @staticmethod
    def defaults(cls: Any, names: tuple[str, ...]) -> Mapping[str, Any]:
        """The values of the fields that have a default."""
        return {name: getattr(cls, name) for name in names if hasattr(cls, name)}

    @staticmethod
    def instructions(cls: Any, names: tuple[str, ...], prefix: str) -> tuple[str, dict[str, Any]]:
        """Statements that store parameters in the fields of ``self``, and the other names that they use, which begin
        with the prefix.
        """
        stores = "".join([f"    {prefix}[{name!r}] = {name}\n" for name in names])
        return f"    {prefix} = self.__dict__\n{stores}", {}


class _InSlots(_InDictionary):
    """How slotted records keep their fields: in slots of the class, of which a class that adds fields is made anew."""

    constructor = staticmethod(_construct_in_slots)
    completing = staticmethod(_construct_in_slots_and_complete)

    @staticmethod
    def prepared(cls: Any) -> Any:
        """The same class with a slot for each field that it adds. TypeError if a base has a dictionary."""
        namespace = {key: value for key, value in vars(cls).items() if key not in {"__dict__", "__weakref__"}}
        fields = _declared_in(namespace.get("__annotations__", {}))
        # A class cannot have an attribute with the name of a slot.
        defaults = {
            **cls.__record_defaults__,
            **{field: namespace.pop(field) for field in fields if field in namespace},
        }
        inherited = field_names_of(cls)
        namespace |= {
            "__qualname__": cls.__qualname__,
            "__slots__": tuple([field for field in fields if field not in inherited]),
            "__record_defaults__": defaults,
        }
        made = type(cls)(cls.__name__, cls.__bases__, namespace)
        if made.__dictoffset__:
            raise TypeError(f"a base of {cls.__name__} is no record, so it has a dictionary")
        return made

    @staticmethod
    def complete(cls: Any) -> None:
        cls.__record_stores__ = tuple([getattr(cls, name).__set__ for name in cls.__record_fields__])
        cls.__reduce__ = _stored

    @staticmethod
    def defaults(cls: Any, names: tuple[str, ...]) -> Mapping[str, Any]:
        found: Mapping[str, Any] = cls.__record_defaults__
        return found

    @staticmethod
    def instructions(cls: Any, names: tuple[str, ...], prefix: str) -> tuple[str, dict[str, Any]]:
        stores = "".join([f"    {prefix}{name}(self, {name})\n" for name in names])
        return stores, {f"{prefix}{name}": getattr(cls, name).__set__ for name in names}


def _layout(cls: type) -> type[_InDictionary]:
    return _InSlots if issubclass(cls, Slotted) else _InDictionary


def _constructor(cls: type, positional: tuple[str, ...], by_name: tuple[str, ...]) -> Constructor:
    """``_construct`` with the fields as its parameters, so the interpreter itself checks each call.

    As in a dataclass, ``__post_init__`` is called if there is one. The instructions of ``_construct`` do not depend on
    its parameters, so nothing has to be compiled.
    """
    layout = _layout(cls)
    defaults = layout.defaults(cls, positional + by_name)
    optional = tuple(name for name in positional if name in defaults)
    if positional[len(positional) - len(optional) :] != optional:
        raise TypeError(f"{cls.__name__} has fields without a default after fields with one")
    template = layout.completing if hasattr(cls, "__post_init__") else layout.constructor
    code = template.__code__.replace(
        co_varnames=("self", *positional, *by_name),
        co_nlocals=1 + len(positional) + len(by_name),
        co_argcount=1 + len(positional),
        co_kwonlyargcount=len(by_name),
        co_qualname=f"{cls.__qualname__}.__init__",
    )
    made = FunctionType(code, globals(), "__init__", tuple(defaults[name] for name in optional))
    made.__kwdefaults__ = {name: defaults[name] for name in by_name if name in defaults}
    return made


def _compile_constructor(cls: Any) -> None:
    """Replaces the instructions of a constructor that is used often by some that store each field by itself, which
    takes less than half of the time; its parameters stay the same.
    """
    made = cls.__init__
    names = made.__code__.co_varnames
    prefix = "_" * (max(map(len, names)) + 1)
    positional = names[: made.__code__.co_argcount]
    parameters = ", ".join([*positional, *(["*", *names[len(positional) :]] if len(names) > len(positional) else [])])
    completed = "    self.__post_init__()\n" if hasattr(cls, "__post_init__") else ""
    stores, scope = _layout(cls).instructions(cls, names[1:], prefix)
    exec(f"def __init__({parameters}):\n{stores}{completed}", scope)
    code = scope["__init__"].__code__.replace(co_qualname=made.__qualname__, co_filename=__file__)
    cls.__init__ = FunctionType(code, scope, "__init__", made.__defaults__)
    cls.__init__.__kwdefaults__ = made.__kwdefaults__


def _equal(self: Any, other: object) -> bool:
    values: Callable[[Any], Any] = self.__record_values__
    return type(self) is type(other) and values(self) == values(other)


def _hash(self: Any) -> int:
    # Cached, because a record may hold a whole program, and is looked up again and again.
    known: int | None = self.__record_hash__
    if known is None:
        known = self.__dict__["__record_hash__"] = hash(self.__record_values__(self))
    return known


def _hash_without_dictionary(self: Any) -> int:
    return hash(self.__record_values__(self))


def _state(self: Any) -> dict[str, Any]:
    # The hash of a text differs from one process to the next, so it is not pickled.
    values: dict[str, Any] = self.__dict__
    if "__record_hash__" not in values:
        return values
    return {name: value for name, value in values.items() if name != "__record_hash__"}


def _less(self: Any, other: Any) -> Any:
    values: Callable[[Any], Any] = self.__record_values__
    return values(self) < values(other) if type(self) is type(other) else NotImplemented


def _no_values(_: object) -> tuple[()]:
    return ()


def _prepared(cls: Any, kw_only: bool) -> Any:
    layout = _layout(cls)
    cls = layout.prepared(cls)
    inherited = field_names_of(cls)
    own = tuple(name for name in _declared_in(cls.__annotations__) if name not in inherited)
    names = inherited + own
    positional: tuple[str, ...] = getattr(cls, "__match_args__", ())
    if not kw_only:
        positional += own
    cls.__record_fields__ = names
    cls.__match_args__ = positional  # type: ignore[misc]
    if "__init__" not in vars(cls):
        by_name = names if not positional else tuple(name for name in names if name not in positional)
        cls.__init__ = _constructor(cls, positional, by_name)
        if names:
            _counts[cls] = 0
    layout.complete(cls)
    for method in ("__setattr__", "__delattr__", "__repr__"):
        if getattr(cls, method) is getattr(object, method):
            setattr(cls, method, getattr(_Shared, method))
    return cls


@dataclass_transform(frozen_default=True, eq_default=False, kw_only_default=True)
def node(cls: type[T]) -> type[T]:
    """A record that compares and hashes by identity; its fields are given by name.

    Annotations must be strings (``from __future__ import annotations``). A call with missing, unknown or too many
    fields raises TypeError.
    """
    prepared: type[T] = _prepared(cls, kw_only=True)
    return prepared


@overload
def record(cls: type[T]) -> type[T]: ...
@overload
def record(*, kw_only: bool = False, eq: bool = True, order: bool = False) -> Callable[[type[T]], type[T]]: ...
@dataclass_transform(frozen_default=True)
def record(
    cls: type[T] | None = None, *, kw_only: bool = False, eq: bool = True, order: bool = False
) -> type[T] | Callable[[type[T]], type[T]]:
    """A record that compares and hashes by value, without the fields named in ``uncompared``: its ``span``, unless it
    says otherwise.

    With ``kw_only`` its own fields are given by name; fields without a default may then follow fields with one. With
    ``order`` records can be sorted; without ``eq`` they compare by identity. A call with missing, unknown or too many
    fields, or with one that is given twice, raises TypeError.
    """
    if cls is None:
        return partial(record, kw_only=kw_only, eq=eq, order=order)
    prepared: type[T] = _prepared(cls, kw_only)
    if eq:
        _compare_by_value(prepared, order)
    return prepared


def _compare_by_value(cls: Any, order: bool) -> None:
    uncompared: frozenset[str] = getattr(cls, "uncompared", _PLACE)
    compared = [name for name in cls.__record_fields__ if name not in uncompared]
    cls.__record_values__ = attrgetter(*compared) if compared else staticmethod(_no_values)
    cls.__eq__ = _equal
    if cls.__dictoffset__:
        cls.__record_hash__ = None
        cls.__hash__ = _hash
        if cls.__getstate__ is object.__getstate__:
            cls.__getstate__ = _state
    else:
        cls.__hash__ = _hash_without_dictionary
    if order:
        cls.__lt__ = _less


def field_names(item: object) -> tuple[str, ...]:
    """The names of a record's fields, in order."""
    return item.__record_fields__  # type: ignore[attr-defined,no-any-return]


ATOMS = frozenset({"str", "str | None", "int", "int | None", "bool", "bool | None"})
"""Annotations of fields in which no record can be."""


def annotations_of(kind: type) -> Mapping[str, str]:
    """The annotations of the fields of a class of records, by name."""
    kinds = (getattr(cls, "__annotations__", {}) for cls in reversed(kind.__mro__))
    return {name: kind for of_class in kinds for name, kind in of_class.items()}


def is_record(item: object) -> bool:
    """Whether ``item`` is a node or a record."""
    return hasattr(type(item), "__record_fields__")


def replaced(item: T, **changes: Any) -> T:
    """A copy of a record with some fields changed."""
    values = {name: getattr(item, name) for name in field_names(item)}
    values.update(changes)
    return type(item)(**values)


def kept_for_same(results: int) -> Callable[[Callable[[T], Result]], Callable[[T], Result]]:
    """Keeps the last results of a function for records, compared by identity: equal ones may have other places in
    the text, and to hash a network takes as long as to search it.
    """

    def keeping(function: Callable[[T], Result]) -> Callable[[T], Result]:
        kept: OrderedDict[int, tuple[T, Result]] = OrderedDict()

        @wraps(function)
        def result(item: T) -> Result:
            found = kept.get(id(item))
            if found is None:
                found = kept[id(item)] = (item, function(item))
                if len(kept) > results:
                    kept.popitem(last=False)
            return found[1]

        return result

    return keeping
