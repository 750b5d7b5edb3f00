"""Messages between places as bytes: numbers, texts, lists, and the values of the program, exact to the bit."""

from __future__ import annotations

import io
import pickle
from types import ModuleType
from typing import Any

from cspdiag.base.errors import CspdiagError
from cspdiag.runtime.kernel.exceptions import Place, ProcessError, text_of


class BadMessageError(CspdiagError, ValueError):
    """Bytes that are no message of a place of this program."""


class Codec:
    """Writes and reads messages. Of all classes only the enums and structs of the program are read, so bytes from a
    network can make nothing else; ``types`` is the module of the package that has them, if there are any.
    """

    def __init__(self, types: ModuleType | None) -> None:
        self._types = types

    def written(self, message: object) -> bytes:
        """A message as bytes."""
        return pickle.dumps(message, protocol=5)

    def read(self, data: bytes) -> Any:
        """The message. Raises BadMessageError."""
        try:
            return _Reader(io.BytesIO(data), self._types).load()
        except Exception as error:
            raise BadMessageError(str(error)) from error


class _Reader(pickle.Unpickler):
    def __init__(self, stream: io.BytesIO, types: ModuleType | None) -> None:
        super().__init__(stream)
        self._types = types

    def find_class(self, module: str, name: str) -> Any:
        """An enum or a struct of the program, whose package has another name in each process."""
        found = getattr(self._types, name, None)
        is_own = isinstance(found, type) and self._types is not None and found.__module__ == self._types.__name__
        if module.endswith(".types") and is_own:
            return found
        raise pickle.UnpicklingError(f"{module}.{name} is no type of the program")


def ended_item(path: str, error: BaseException | None) -> tuple[Any, ...]:
    """What other places get to know of an instance that has ended: its exception in words."""
    if error is None:
        return ("ended", path, None)
    place = getattr(error, "place", None)
    return ("ended", path, (type(error).__name__, text_of(error), None if place is None else str(place)))


def error_of(kind: str, text: str, place: str | None) -> ProcessError:
    """An exception of a process in another place."""
    error: ProcessError = type(kind, (ProcessError,), {})(*([text] if text else []))
    error.place = None if place is None else Place(place)
    return error
