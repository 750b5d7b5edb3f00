"""The parameters of the server's own requests and of its command, which pygls does not check."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence

from lsprotocol import types
from pygls.exceptions import JsonRpcInvalidParams

from cspdiag.base.record import record

OWN = frozenset(("cspdiag/program", "cspdiag/diagram"))
"""The requests whose parameters are given to their functions as they were sent."""
_LARGEST = 2**31 - 1
"""Of the unsigned integers of the protocol."""


@record
class ProgramParams:
    """Which open program is meant."""

    uri: str

    @classmethod
    def of(cls, sent: object) -> ProgramParams:
        """Raises JsonRpcInvalidParams for parameters that are none."""
        return cls(_uri(_object(sent, "`params`")))


@record
class DiagramParams:
    """Which diagram is meant: of a process, or at a position. ``wanted`` is what else is given."""

    uri: str
    position: types.Position | None
    wanted: Mapping[str, str]

    @classmethod
    def of(cls, sent: object) -> DiagramParams:
        """Raises JsonRpcInvalidParams for parameters that are none."""
        params = _object(sent, "`params`")
        given = {name: params.get(name) for name in ("process", "which", "format", "scheme")}
        wanted = {name: _text(value, f"`{name}`") for name, value in given.items() if value is not None}
        position = params.get("position")
        return cls(_uri(params), None if position is None else _position(position), wanted)


@record
class AssertionParams:
    """Which assertion of an open program is meant: that in a line, from 0."""

    uri: str
    line: int

    @classmethod
    def of(cls, sent: Sequence[object]) -> AssertionParams:
        """Raises JsonRpcInvalidParams for arguments that are none."""
        if len(sent) != 2:
            raise JsonRpcInvalidParams(f"the arguments have to be a URI and a line, and are {json.dumps(sent)}")
        return cls(_text(sent[0], "the URI"), _count(sent[1], "the line"))


def _uri(params: Mapping[str, object]) -> str:
    return _text(_object(params.get("textDocument"), "`textDocument`").get("uri"), "`textDocument.uri`")


def _position(sent: object) -> types.Position:
    position = _object(sent, "`position`")
    return types.Position(*(_count(position.get(name), f"`position.{name}`") for name in ("line", "character")))


def _object(value: object, name: str) -> Mapping[str, object]:
    if isinstance(value, Mapping):
        return value
    raise _refusal(value, name, "an object")


def _text(value: object, name: str) -> str:
    if isinstance(value, str):
        return value
    raise _refusal(value, name, "a text")


def _count(value: object, name: str) -> int:
    if isinstance(value, int) and not isinstance(value, bool) and 0 <= value <= _LARGEST:
        return value
    raise _refusal(value, name, "a whole number from 0 on")


def _refusal(value: object, name: str, needed: str) -> JsonRpcInvalidParams:
    found = "missing" if value is None else json.dumps(value)
    return JsonRpcInvalidParams(f"{name} has to be {needed}, and is {found}")
