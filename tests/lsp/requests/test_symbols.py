"""The definitions of a workspace, by the letters of their names."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pytest
from lsprotocol import types

from tests.lsp.editor import Client, Editor, place

pytestmark = pytest.mark.asyncio(loop_scope="module")


async def found(client: Client, query: str) -> list[str]:
    """The kind and the name of each, and where it is."""
    symbols = await client.workspace_symbol_async(types.WorkspaceSymbolParams(query))
    assert isinstance(symbols, Sequence)
    lines = []
    for each in symbols:
        assert isinstance(each.location, types.Location)
        file = each.location.uri.rsplit("/", 1)[-1]
        lines.append(f"{each.kind.name.lower()} {each.name} {file}:{place(each.location.range.start)}")
    return lines


async def test_the_definitions_of_all_programs_of_the_folder_are_found(client: Client, tmp_path: Path) -> None:
    """Of open ones as they are in the editor, also of those with mistakes and of those in no folder."""
    folder = tmp_path / "my crane"
    (folder / "lib").mkdir(parents=True)
    (folder / "lib" / "laws.csp").write_text("submodel HoistLaw { out y : double y = 1 }\n// process Hidden {\n")
    (folder / "main.csp").write_text("process Main { composition { skip } }\n")
    (folder / "latin.csp").write_bytes(b"process Hoist\xe9 { }\n")
    (tmp_path / "other.csp").write_text("process HoistOther { composition { skip } }\n")
    event = types.WorkspaceFoldersChangeEvent([types.WorkspaceFolder(folder.as_uri(), "crane")], [])
    client.workspace_did_change_workspace_folders(types.DidChangeWorkspaceFoldersParams(event))
    inside, outside = Editor(client, folder), Editor(client, tmp_path)
    await inside.open(
        "main.csp", "enum HoistMode { up, down }\nprocess Hoist { composition { ( } }\nassert Hoist terminates\n"
    )
    await outside.open("alone.csp", "environment HoistBench for Hoist { }\n")
    assert await found(client, "hoist") == [
        "enum HoistMode main.csp:1:6",
        "class Hoist main.csp:2:9",
        "function HoistLaw laws.csp:1:10",
        "module HoistBench alone.csp:1:13",
    ]
    assert await found(client, "hsmd") == ["enum HoistMode main.csp:1:6"]
    assert await found(client, "hidden") == []
    assert len(await found(client, "")) == 4
    await inside.close()
    await outside.close()
    removed = types.WorkspaceFoldersChangeEvent([], [types.WorkspaceFolder(folder.as_uri(), "crane")])
    client.workspace_did_change_workspace_folders(types.DidChangeWorkspaceFoldersParams(removed))
