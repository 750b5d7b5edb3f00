"""Changes of imported files: what the editor shows in the files that import them belongs to the program as it is."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from cspdiag.lsp.features.lenses import RUN, lenses
from cspdiag.lsp.session import Session
from tests.lsp.editor import Client, Editor

pytestmark = pytest.mark.asyncio(loop_scope="module")

MAIN = """import "laws.csp"
process Main { composition { wait T } }
environment Bench for Main { }
"""
LAWS = "const T = 100 ms\n"


def fingerprint(session: Session, uri: str) -> str:
    """The last argument of the lens that runs the program."""
    document = session.documents.get(uri)
    assert document is not None
    (command,) = [each.command for each in lenses(session.view(document), uri, session.positions, frozenset({RUN}))]
    assert command is not None
    assert command.arguments is not None
    found = command.arguments[-1]
    assert isinstance(found, str)
    return found


async def test_the_lens_of_a_run_has_another_fingerprint_after_an_import_has_changed(tmp_path: Path) -> None:
    session, main, laws = Session(), (tmp_path / "main.csp").as_uri(), (tmp_path / "laws.csp").as_uri()
    (tmp_path / "laws.csp").write_text(LAWS)
    session.documents.open(main, MAIN, 1)
    before = fingerprint(session, main)
    assert fingerprint(session, main) == before
    session.documents.open(laws, LAWS, 1)
    assert fingerprint(session, main) == before
    session.documents.open(laws, LAWS.replace("100", "200"), 2)
    assert fingerprint(session, main) != before
    session.documents.open(laws, LAWS, 3)
    assert fingerprint(session, main) == before
    session.documents.close(laws)
    (tmp_path / "laws.csp").write_text(LAWS.replace("100", "300"))
    assert fingerprint(session, main) != before


async def test_a_program_says_which_files_it_has(client: Client, tmp_path: Path) -> None:
    (tmp_path / "laws.csp").write_text(LAWS)
    editor = Editor(client, tmp_path)
    await editor.open("main.csp", MAIN)
    found: Any = await client.protocol.send_request_async(
        "cspdiag/program", {"textDocument": {"uri": editor.uri("main.csp")}}
    )
    assert set(found.files) == {editor.uri("main.csp"), editor.uri("laws.csp")}
    await editor.close()


async def test_what_is_shown_in_a_file_is_asked_for_again_when_an_import_changes(
    client: Client, tmp_path: Path
) -> None:
    laws, main = Editor(client, tmp_path), Editor(client, tmp_path)
    await laws.open("laws.csp", LAWS)
    assert await main.open("main.csp", MAIN) == []
    client.refreshed.clear()
    await main.replace(MAIN + "// Changed.\n")
    await main.answer("lenses")
    assert client.refreshed == set()
    await laws.replace(LAWS.replace("100", "200"))
    await main.diagnostics_of("main.csp", 2)
    await main.answer("lenses")
    # The editor of the tests has no hints.
    assert client.refreshed == {"lenses", "tokens"}
    for each in (laws, main):
        await each.close()
