"""Requests with parameters that are none: an error of the protocol, and nothing in the log."""

from __future__ import annotations

import asyncio
from concurrent.futures import Future
from pathlib import Path
from typing import Any

import pytest
from lsprotocol import types
from pygls.exceptions import JsonRpcException, JsonRpcInvalidParams

from tests.lsp.editor import PATIENCE, Client, Editor

pytestmark = pytest.mark.asyncio(loop_scope="module")
NOWHERE: dict[str, Any] = {"textDocument": {"uri": "file:///nowhere/main.csp"}}
BAD: list[tuple[object, str]] = [
    (None, "`params` has to be an object, and is missing"),
    ([1], "`params` has to be an object, and is [1]"),
    ({}, "`textDocument` has to be an object, and is missing"),
    ({"textDocument": {}}, "`textDocument.uri` has to be a text, and is missing"),
    ({"textDocument": {"uri": 3}}, "`textDocument.uri` has to be a text, and is 3"),
]
BAD_FOR_DIAGRAMS: list[tuple[object, str]] = [
    ({**NOWHERE, "position": 3}, "`position` has to be an object, and is 3"),
    (
        {**NOWHERE, "position": {"line": -1, "character": 0}},
        "`position.line` has to be a whole number from 0 on, and is -1",
    ),
    (
        {**NOWHERE, "position": {"line": 0, "character": True}},
        "`position.character` has to be a whole number from 0 on, and is true",
    ),
    *(({**NOWHERE, name: 3}, f"`{name}` has to be a text, and is 3") for name in ("process", "which", "format")),
]
BAD_FOR_PROOFS: list[tuple[list[Any] | None, str]] = [
    (None, "the arguments have to be a URI and a line, and are []"),
    ([3, 4], "the URI has to be a text, and is 3"),
    (["file:///nowhere/main.csp", "x"], 'the line has to be a whole number from 0 on, and is "x"'),
]


async def refused(client: Client, method: str, params: object) -> str:
    """The message of an error InvalidParams."""
    with pytest.raises(JsonRpcException) as problem:
        await client.protocol.send_request_async(method, params)
    assert problem.value.code == JsonRpcInvalidParams.CODE
    return str(problem.value.message)


@pytest.mark.parametrize(
    ("method", "params", "says"),
    [
        *(("cspdiag/program", params, says) for params, says in BAD),
        *(("cspdiag/diagram", params, says) for params, says in [*BAD, *BAD_FOR_DIAGRAMS]),
    ],
)
async def test_a_request_of_the_server_says_what_its_parameters_have_to_be(
    client: Client, method: str, params: object, says: str
) -> None:
    assert await refused(client, method, params) == says


@pytest.mark.parametrize(("arguments", "says"), BAD_FOR_PROOFS)
async def test_and_so_does_its_command(client: Client, arguments: list[Any] | None, says: str) -> None:
    params = types.ExecuteCommandParams("cspdiag.verify", arguments)
    assert await refused(client, types.WORKSPACE_EXECUTE_COMMAND, params) == says


async def test_other_parameters_may_be_sent_as_well(client: Client, tmp_path: Path) -> None:
    editor = Editor(client, tmp_path)
    await editor.open("main.csp", "process Main { composition { skip } }\n")
    params = {"textDocument": {"uri": editor.uri("main.csp"), "a-b": 1}, "class": {"x": 2}}
    found: Any = await client.protocol.send_request_async("cspdiag/program", params)
    assert found.files == [editor.uri("main.csp")]
    await editor.close()


AT: dict[str, Any] = {**NOWHERE, "position": {"line": 0, "character": 0}}
RANGE: dict[str, Any] = {"start": {"line": 0, "character": 0}, "end": {"line": 0, "character": 0}}


@pytest.mark.parametrize(
    ("method", "params", "says"),
    [
        ("textDocument/hover", NOWHERE, "required field missing @ message.params.position"),
        ("textDocument/hover", None, "params"),
        ("textDocument/hover", [1], "params"),
        ("textDocument/hover", {**NOWHERE, "position": {"line": "x", "character": 0}}, "params.position.line"),
        ("textDocument/hover", {**AT, "textDocument": {"uri": 3}}, "expected str @ message.params.text_document.uri"),
        ("textDocument/completion", {**AT, "context": {}}, "params.context"),
        ("textDocument/completion", {**AT, "context": {"triggerKind": 99}}, "message.params.context.trigger_kind"),
        ("textDocument/codeAction", {**NOWHERE, "range": RANGE, "context": {}}, "params.context.diagnostics"),
        ("textDocument/codeAction", {**NOWHERE, "range": RANGE, "context": {"diagnostics": 7}}, "params.context"),
        ("textDocument/rename", {**AT, "newName": None}, "expected str @ message.params.new_name"),
    ],
)
async def test_a_request_of_the_protocol_says_which_of_its_parameters_is_none(
    client: Client, method: str, params: object, says: str
) -> None:
    answer: Future[object] = Future()
    # As they are: pygls would refuse to send them.
    client.protocol._request_futures["misread"] = answer
    client.protocol._send_data({"jsonrpc": "2.0", "id": "misread", "method": method, "params": params})
    with pytest.raises(JsonRpcException) as problem:
        await asyncio.wait_for(asyncio.wrap_future(answer), PATIENCE)
    assert problem.value.code == JsonRpcInvalidParams.CODE
    assert says in str(problem.value.message)
    assert client.messages == []
