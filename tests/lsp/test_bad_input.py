"""Files that cannot be read, are too large or vanish, names of folders, several editors, servers that are killed."""

from __future__ import annotations

import importlib
import json
import logging
import os
import re
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pygls.protocol.json_rpc
import pytest
from lsprotocol import types
from pygls.exceptions import JsonRpcInvalidParams

from cspdiag.lsp.documents import MAX_CHARACTERS
from cspdiag.lsp.session import Session
from tests.lsp.editor import Client, Editor, all_diagnostics, described

pytestmark = pytest.mark.asyncio(loop_scope="module")
SLIP = "const period = 1 ms\nconst slow = 10 * peroid\n"
COMMAND = [sys.executable, "-m", "cspdiag", "lsp"]


async def test_an_import_that_is_not_utf_8_is_reported(client: Client, tmp_path: Path) -> None:
    (tmp_path / "laws.csp").write_bytes(b"// \xff\xfe\n")
    found = await Editor(client, tmp_path).open("main.csp", 'import "laws.csp"\n')
    assert "not UTF-8 text (byte 0xff at offset 3)" in described(found)


async def test_an_open_file_that_is_not_utf_8_is_reported_as_long_as_it_is_so(client: Client, tmp_path: Path) -> None:
    (tmp_path / "laws.csp").write_bytes(b"const a = 1 // caf\xe9\n")
    laws, main = Editor(client, tmp_path), Editor(client, tmp_path)
    for shown in ("caf\ufffd", "caf\xe9"):
        (only,) = await laws.open("laws.csp", f"const a = 1 // {shown}\n")
        assert only.severity == types.DiagnosticSeverity.Error
        assert "the file is not UTF-8 text (byte 0xe9 at offset 18)" in only.message
        assert ("saved as it is shown, it loses" in only.message) == ("\ufffd" in shown)
    assert only.range.start.character == 0
    assert "not UTF-8 text" in described(await main.open("main.csp", 'import "laws.csp"\nconst b = a\n'))
    for saved, severities in (("caf\ufffd", [types.DiagnosticSeverity.Warning]), ("caf\xe9", [])):
        found = await laws.replace(f"const a = 1 // {saved}\n")
        (tmp_path / "laws.csp").write_text(laws.text, encoding="utf-8")
        client.text_document_did_save(types.DidSaveTextDocumentParams(laws.document))
        found = await laws.diagnostics_of("laws.csp", laws.version)
        assert [each.severity for each in found] == severities
    assert described(await main.replace('import "laws.csp"\nconst b = a // \n')) == "nothing\n"
    for each in (laws, main):
        await each.close()


async def test_a_file_of_ten_megabytes_is_not_checked_and_says_so(client: Client, tmp_path: Path) -> None:
    editor = Editor(client, tmp_path)
    (only,) = await editor.open("main.csp", "const a§ = 1\n" + "const a = 1\n" * 800_000)
    assert only.severity == types.DiagnosticSeverity.Information
    assert f"more than the {MAX_CHARACTERS}" in only.message
    assert await editor.answer("hover") == "nothing\n"
    assert await editor.replace(SLIP) != []
    await editor.close()


async def test_nor_is_a_file_that_imports_one(client: Client, tmp_path: Path) -> None:
    (tmp_path / "large.csp").write_text("const a = 1\n" * 800_000)
    found = await Editor(client, tmp_path).open("main.csp", 'import "large.csp"\nconst b = a§\n')
    assert f"it has 9600000 characters, more than the {MAX_CHARACTERS}" in described(found)
    assert f"the file is {tmp_path}/large.csp" in described(found)


async def test_changes_during_a_check_are_checked_once(tmp_path: Path) -> None:
    server, last = _Server(tmp_path), 41
    try:
        server.open("main.csp", "\n" + "".join(f"const a{number} = {number} + 1\n" for number in range(2000)))
        for version in range(2, last + 1):
            server.insert("main.csp", " ", version)
        versions = []
        while last not in versions:
            versions.append(server.published_json()["version"])
        assert versions == sorted(versions)
        assert len(versions) < last / 2
    finally:
        server.kill()


async def test_a_file_that_is_deleted_while_it_is_open_keeps_its_text(client: Client, tmp_path: Path) -> None:
    for name, text in (("main.csp", 'import "laws.csp"\nconst b = a'), ("laws.csp", "const a = 1\n")):
        (tmp_path / name).write_text(text)
    editor = Editor(client, tmp_path)
    assert await editor.open("main.csp", 'import "laws.csp"\nconst b = §a\n') == []
    (tmp_path / "main.csp").unlink()
    assert "const a = 1" in await editor.answer("hover")
    (tmp_path / "laws.csp").unlink()
    assert "cannot import" in described(await editor.replace('import "laws.csp"\nconst b = a // \n'))
    await editor.close()


async def test_a_file_that_is_created_is_found(client: Client, tmp_path: Path) -> None:
    editor = Editor(client, tmp_path)
    assert await editor.open("main.csp", 'import "laws.csp"\nconst b = a\n') != []
    (tmp_path / "laws.csp").write_text("const a = 1\n")
    event = types.FileEvent(editor.uri("laws.csp"), types.FileChangeType.Created)
    client.workspace_did_change_watched_files(types.DidChangeWatchedFilesParams([event]))
    assert await editor.diagnostics_of("main.csp", 1) == []
    await editor.close()


async def test_files_on_a_disk_that_cannot_be_written(client: Client, tmp_path: Path) -> None:
    folder = tmp_path / "disk"
    folder.mkdir()
    (folder / "laws.csp").write_text("const a = 1\n")
    (folder / "laws.csp").chmod(0o400)
    folder.chmod(0o500)
    editor = Editor(client, folder)
    try:
        assert await editor.open("main.csp", 'import "laws.csp"\nconst b = §a\n') == []
        assert "const a = 1" in await editor.answer("hover")
        if not os.access(folder / "laws.csp", os.W_OK):
            assert "is read-only" in await editor.answer("rename")
    finally:
        folder.chmod(0o700)
    await editor.close()


@pytest.mark.parametrize("name", ["a folder", "c#", "100%", "ünïcode", "a+b&c"])
async def test_folders_with_unusual_names(client: Client, tmp_path: Path, name: str) -> None:
    folder = tmp_path / name
    folder.mkdir()
    (folder / "laws.csp").write_text("const a = peroid\n")
    editor = Editor(client, folder)
    assert await editor.open("main.csp", 'import "laws.csp"\nconst b = §a\n') == []
    assert await editor.answer("definition") == "laws.csp:1:7-1:8\n"
    assert "no value `peroid`" in await all_diagnostics(editor)
    await editor.close()


async def test_characters_outside_the_basic_plane_and_other_line_ends(client: Client, tmp_path: Path) -> None:
    editor = Editor(client, tmp_path)
    text = "// \N{ROCKET}\u2028\x0c\r\n/* \N{ROCKET} */ const period = 1 ms\r\nconst slow = 10 * peroid\r\n"
    assert "3:19-3:25 error[E0204]" in described(await editor.open("main.csp", text))
    place = types.Position(1, 9)
    change = types.TextDocumentContentChangePartial(types.Range(place, types.Position(1, 14)), "const")
    assert "see 2:16-2:22" in described(await editor.change(change))
    await editor.close()


@pytest.mark.parametrize("mark", ["", "\ufeff"])
async def test_formatting_and_fixes_keep_the_line_ends_and_the_mark_of_a_file(
    client: Client, tmp_path: Path, mark: str
) -> None:
    editor = Editor(client, tmp_path)
    text = f"{mark}const   period = 1 ms\r\nconst slow = 10 * period\r\nconst  last = 1\r\n"
    assert await editor.open("main.csp", text) == []
    params = types.DocumentFormattingParams(editor.document, types.FormattingOptions(2, insert_spaces=True))
    edits = await client.text_document_formatting_async(params)
    assert edits is not None
    formatted = editor.edited(types.WorkspaceEdit(changes={editor.uri("main.csp"): list(edits)}))
    assert formatted == re.sub("  +", " ", text)
    await editor.replace(formatted)
    assert not await client.text_document_formatting_async(params)
    slip = mark + SLIP.replace("\n", "\r\n")
    await editor.replace(slip.replace("peroid", "§peroid"))
    assert slip.replace("peroid", "period") in await editor.answer("actions")
    await editor.close()


async def test_two_names_of_one_file_are_one_file(client: Client, tmp_path: Path) -> None:
    (tmp_path / "laws.csp").write_text("const a = 1\n")
    (tmp_path / "link.csp").symlink_to(tmp_path / "laws.csp")
    editor = Editor(client, tmp_path)
    assert await editor.open("link.csp", "const a = 1\nconst c = 2\n") == []
    other = Editor(client, tmp_path)
    # What is not saved under one name is seen under the other.
    assert await other.open("main.csp", 'import "laws.csp"\nconst b = c\n') == []
    await other.close()
    await editor.close()


async def test_an_importing_file_is_checked_again_when_an_open_one_changes(client: Client, tmp_path: Path) -> None:
    laws, main = Editor(client, tmp_path), Editor(client, tmp_path)
    await laws.open("laws.csp", "const a = 1\n")
    assert await main.open("main.csp", 'import "laws.csp"\nconst b = a\n') == []
    await laws.replace("const other = 1\n")
    assert "no value `a`" in described(await main.diagnostics_of("main.csp", 1))
    # A file that is closed without saving is that on disk again.
    (tmp_path / "laws.csp").write_text("const a = 2\n")
    await laws.close()
    assert await main.diagnostics_of("main.csp", 1) == []
    await main.close()


async def test_two_servers_on_one_file_do_not_disturb_each_other(tmp_path: Path) -> None:
    (tmp_path / "main.csp").write_text(SLIP)
    one, other = _Server(tmp_path), _Server(tmp_path)
    try:
        for server in (one, other):
            server.open("main.csp", SLIP)
        assert "peroid" in one.published()
        assert "peroid" in other.published()
        one.kill()
        other.change("main.csp", "const period = 1 ms\n")
        assert '"diagnostics": []' in json.dumps(other.published_json())
    finally:
        for server in (one, other):
            server.kill()
    assert (tmp_path / "main.csp").read_text() == SLIP
    assert sorted(os.listdir(tmp_path)) == ["main.csp"]


async def test_a_server_that_was_killed_can_be_started_again(tmp_path: Path) -> None:
    first = _Server(tmp_path)
    first.open("main.csp", SLIP)
    first.kill()
    second = _Server(tmp_path)
    try:
        second.open("main.csp", SLIP)
        assert "peroid" in second.published()
    finally:
        second.kill()


async def test_the_server_ends_with_its_input(tmp_path: Path) -> None:
    server = _Server(tmp_path)
    server.open("main.csp", SLIP)
    server.published()
    assert server.end() == 0


async def test_ctrl_c_ends_the_server(tmp_path: Path) -> None:
    server = _Server(tmp_path)
    server.open("main.csp", SLIP)
    server.published()
    assert server.interrupt() == -signal.SIGINT


async def test_a_message_that_is_damaged_does_not_end_the_server(tmp_path: Path) -> None:
    server = _Server(tmp_path)
    try:
        server.send_raw(b"Content-Length: 5\r\n\r\n{nope")
        server.open("main.csp", SLIP)
        assert "peroid" in server.published()
    finally:
        server.kill()


async def test_a_refused_request_is_no_failure_in_the_log(caplog: pytest.LogCaptureFixture) -> None:
    importlib.import_module("cspdiag.lsp.server")
    log = logging.getLogger(pygls.protocol.json_rpc.__name__)
    for problem in (JsonRpcInvalidParams("`1` is not a name"), ValueError("wrong")):
        try:
            raise problem
        except (JsonRpcInvalidParams, ValueError):
            log.exception("request 1")
    assert [record.exc_info[1] for record in caplog.records if record.exc_info] == [problem]


async def test_that_an_answer_which_was_given_is_not_wanted_is_no_failure_in_the_log(
    client: Client, caplog: pytest.LogCaptureFixture
) -> None:
    importlib.import_module("cspdiag.lsp.server")
    pygls.protocol.JsonRPCProtocol._handle_cancel_notification(client.protocol, "46")
    assert not caplog.records


async def test_trees_of_closed_files_are_forgotten(tmp_path: Path) -> None:
    session = Session()
    for number in range(50):
        path = tmp_path / f"{number}.csp"
        document = session.documents.open(path.as_uri(), "const a = 1\n", 1)
        assert session.diagnostics(document) == []
        session.close(path.as_uri())
    assert session.remembered == 0


class _Server:
    """A server without a client: messages are written and read one by one."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._process = subprocess.Popen(
            COMMAND, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
        )
        self.send("initialize", {"processId": None, "rootUri": folder.as_uri(), "capabilities": {}}, number=1)
        self.send("initialized", {})

    def send(self, method: str, params: object, number: int | None = None) -> None:
        message = {"jsonrpc": "2.0", "method": method, "params": params, **({} if number is None else {"id": number})}
        data = json.dumps(message).encode()
        self.send_raw(b"Content-Length: %d\r\n\r\n%s" % (len(data), data))

    def send_raw(self, data: bytes) -> None:
        assert self._process.stdin is not None
        self._process.stdin.write(data)
        self._process.stdin.flush()

    def open(self, name: str, text: str) -> None:
        document = {"uri": (self._folder / name).as_uri(), "languageId": "csp", "version": 1, "text": text}
        self.send("textDocument/didOpen", {"textDocument": document})

    def change(self, name: str, text: str) -> None:
        document = {"uri": (self._folder / name).as_uri(), "version": 2}
        self.send("textDocument/didChange", {"textDocument": document, "contentChanges": [{"text": text}]})

    def insert(self, name: str, text: str, version: int) -> None:
        """Insert a text at the beginning."""
        document = {"uri": (self._folder / name).as_uri(), "version": version}
        beginning = {"line": 0, "character": 0}
        change = {"range": {"start": beginning, "end": beginning}, "text": text}
        self.send("textDocument/didChange", {"textDocument": document, "contentChanges": [change]})

    def published(self) -> str:
        return json.dumps(self.published_json())

    def published_json(self) -> Any:
        """The next diagnostics."""
        stream = self._process.stdout
        assert stream is not None
        while True:
            length = 0
            while line := stream.readline().strip():
                name, _, value = line.partition(b":")
                if name.lower() == b"content-length":
                    length = int(value)
            assert length, "the server has ended"
            message = json.loads(stream.read(length))
            if message.get("method") == "textDocument/publishDiagnostics":
                return message["params"]

    def end(self) -> int:
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.close()
        self._process.stdout.read()
        self._process.stdout.close()
        return self._process.wait(10)

    def interrupt(self) -> int:
        self._process.send_signal(signal.SIGINT)
        code = self._process.wait(10)
        self.kill()
        return code

    def kill(self) -> None:
        self._process.kill()
        self._process.wait()
        for stream in (self._process.stdin, self._process.stdout):
            assert stream is not None
            if not stream.closed:
                stream.close()
