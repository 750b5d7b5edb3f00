"""Proofs that take long: the editor shows them, can cancel them, and shows it if the text has changed meanwhile."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import Any

import pytest
from lsprotocol import types

from tests.lsp.editor import PATIENCE, Client, Editor

pytestmark = pytest.mark.asyncio(loop_scope="module")

PROGRAM = "process Main { composition { stop } }\nassert Main deadlock free\n"
DINING = Path(__file__).parents[3] / "models" / "dining"
TABLE = (DINING / "table.csp").read_text().replace("seats = 5", "seats = 120")
MANY_SEATS = TABLE + (DINING / "dining.csp").read_text().replace('import "table.csp"\n', "")
"""A program whose proof takes some ten seconds."""


async def titles(editor: Editor) -> list[str]:
    found = await editor.client.text_document_code_lens_async(types.CodeLensParams(editor.document))
    return [lens.command.title for lens in found or () if lens.command is not None]


def verify(editor: Editor, line: int) -> asyncio.Future[Any]:
    command = types.ExecuteCommandParams("cspdiag.verify", [editor.uri(editor.main), line])
    return asyncio.wrap_future(editor.client.workspace_execute_command(command))


async def test_after_a_change_the_lens_has_the_answer_of_before(client: Client, tmp_path: Path) -> None:
    editor = Editor(client, tmp_path)
    await editor.open("main.csp", PROGRAM)
    reason = "`Main` can deadlock: at once, a process waits for something that never happens"
    under_way = verify(editor, 1)
    await editor.replace(f"// A comment.\n{PROGRAM}")
    assert await asyncio.wait_for(under_way, PATIENCE) == f"Refuted: {reason}"
    assert await titles(editor) == [f"Verify again (refuted before the change: {reason})"]
    await asyncio.wait_for(verify(editor, 2), PATIENCE)
    assert await titles(editor) == [f"Refuted: {reason}"]
    await editor.replace(PROGRAM.replace("stop", "skip"))
    assert await titles(editor) == [f"Verify again (refuted before the change: {reason})"]
    await editor.close()


async def test_the_reason_why_nothing_is_proved_comes_first(client: Client, tmp_path: Path) -> None:
    editor = Editor(client, tmp_path)
    await editor.open("main.csp", PROGRAM.replace("stop", "missing"))
    assert await asyncio.wait_for(verify(editor, 1), PATIENCE) is None
    assert client.messages[-1].message == "Not proved: the program has errors (`assert Main deadlock free`)"
    await editor.close()


async def test_an_assertion_about_a_process_without_values_does_not_keep_others_from_being_proved(
    client: Client, tmp_path: Path
) -> None:
    editor = Editor(client, tmp_path)
    program = "process Open(n: int) { composition { stop } }\nassert Open deadlock free\n"
    await editor.open("main.csp", program + PROGRAM)
    assert str(await asyncio.wait_for(verify(editor, 3), PATIENCE)).startswith("Refuted: ")
    reason = "`Open` has no value for its parameter `n`, so nothing can be proved of it"
    assert await asyncio.wait_for(verify(editor, 1), PATIENCE) == f"Not proved: {reason}"
    assert (await titles(editor))[0] == f"Not proved: {reason}"
    await editor.close()


async def test_a_proof_is_shown_and_can_be_cancelled(client: Client, tmp_path: Path) -> None:
    editor = Editor(client, tmp_path)
    await editor.open("main.csp", MANY_SEATS)
    line = MANY_SEATS.count("\n") - 1
    known = set(client.progress)
    under_way = verify(editor, line)
    begun = await asyncio.wait_for(_begun(client, known), PATIENCE)
    (shown,) = client.progress[begun]
    assert (shown["title"], shown["cancellable"]) == ("Verifying `assert Table deadlock free`", True)
    client.window_work_done_progress_cancel(types.WorkDoneProgressCancelParams(begun))
    assert await asyncio.wait_for(under_way, PATIENCE) is None
    assert client.progress[begun][-1]["kind"] == "end"
    assert "Verify" in await titles(editor)
    await editor.close()


async def _begun(client: Client, known: set[types.ProgressToken]) -> types.ProgressToken:
    while not (begun := client.progress.keys() - known):
        await asyncio.sleep(0.05)
    return begun.pop()
