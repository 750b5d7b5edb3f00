"""Changes of imported files and of bodies: what the editor shows in the files that name them belongs to the program as
it is.
"""

from __future__ import annotations

import zipfile
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


BODIES = """submodel Loop python "loop.py:Loop" { in a : double out b : double }
submodel Law c "law.c" { in a : double out b : double }
submodel Plant fmu "plant.fmu" { in a : double out b : double }
process Main { composition { wait 1 s } }
environment Bench for Main { }
"""


DESCRIPTION = """<?xml version="1.0"?>
<fmiModelDescription fmiVersion="2.0" modelName="Plant" guid="{}" numberOfEventIndicators="0">
  <CoSimulation modelIdentifier="plant"/>
  <ModelVariables>
    <ScalarVariable name="NAME" valueReference="0" causality="input"><Real start="0"/></ScalarVariable>
    <ScalarVariable name="b" valueReference="1" causality="output" initial="calculated"><Real/></ScalarVariable>
  </ModelVariables>
  <ModelStructure><Outputs><Unknown index="2"/></Outputs></ModelStructure>
</fmiModelDescription>
"""


async def test_the_lens_of_a_run_has_another_fingerprint_after_a_body_has_changed(tmp_path: Path) -> None:
    session, uri = Session(), (tmp_path / "main.csp").as_uri()
    session.documents.open(uri, BODIES, 1)
    without = fingerprint(session, uri)
    for name in ("loop.py", "law.c", "law.h", "plant.fmu"):
        (tmp_path / name).write_text("before")
        before = fingerprint(session, uri)
        (tmp_path / name).write_text("after it")
        session.imports_changed = False
        assert fingerprint(session, uri) not in (without, before)
        assert session.imports_changed
        (tmp_path / name).write_text("before")
        assert fingerprint(session, uri) == before
        (tmp_path / name).unlink()
    assert fingerprint(session, uri) == without


async def test_a_program_is_checked_again_when_the_description_of_an_fmu_changes(tmp_path: Path) -> None:
    session, uri = Session(), (tmp_path / "main.csp").as_uri()
    document = session.documents.open(uri, BODIES.split("\n", 2)[2], 1)

    def found(variable: str) -> str:
        with zipfile.ZipFile(tmp_path / "plant.fmu", "w") as archive:
            archive.writestr("modelDescription.xml", DESCRIPTION.replace("NAME", variable))
        return "\n".join(each.message for each in session.diagnostics(document))

    assert found("a") == ""
    assert "`a`" in found("other")
    assert found("a") == ""


async def test_a_program_says_which_files_it_has(client: Client, tmp_path: Path) -> None:
    (tmp_path / "laws.csp").write_text(LAWS)
    editor = Editor(client, tmp_path)
    await editor.open("main.csp", MAIN)
    found: Any = await client.protocol.send_request_async(
        "cspdiag/program", {"textDocument": {"uri": editor.uri("main.csp")}}
    )
    assert set(found.files) == {editor.uri("main.csp"), editor.uri("laws.csp")}
    (tmp_path / "loop.py").touch()
    await editor.replace(BODIES)
    found = await client.protocol.send_request_async(
        "cspdiag/program", {"textDocument": {"uri": editor.uri("main.csp")}}
    )
    assert set(found.files) == {editor.uri("main.csp"), editor.uri("loop.py")}
    await editor.close()


async def test_a_text_in_no_file_imports_from_the_present_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "laws.csp").write_text(LAWS)
    monkeypatch.chdir(tmp_path)
    session = Session()
    view = session.view(session.documents.open("untitled:Untitled-1", MAIN, 1))
    assert [session.documents.uri(name) for name in view.files] == [
        (tmp_path / "laws.csp").as_uri(),
        "untitled:Untitled-1",
    ]


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


async def test_changes_on_the_disk_that_the_editor_does_not_tell_of_are_noticed(client: Client, tmp_path: Path) -> None:
    """An editor watches only the folders that it has open."""
    (tmp_path / "laws.csp").write_text(LAWS)
    main = Editor(client, tmp_path)
    assert await main.open("main.csp", MAIN) == []
    client.refreshed.clear()
    (tmp_path / "laws.csp").rename(tmp_path / "away.csp")
    assert "E0120" in [each.code for each in await main.diagnostics_of("main.csp", 1)]
    await main.answer("lenses")
    assert "lenses" in client.refreshed
    (tmp_path / "away.csp").rename(tmp_path / "laws.csp")
    assert await main.diagnostics_of("main.csp", 1) == []
    await main.close()


async def test_changes_on_the_disk_are_found_once(tmp_path: Path) -> None:
    session, uri, laws = Session(), (tmp_path / "main.csp").as_uri(), tmp_path / "laws.csp"
    laws.write_text(LAWS)
    document = session.documents.open(uri, MAIN, 1)
    session.diagnostics(document)
    assert session.changed_on_disk() == []
    laws.write_text(LAWS + "// Longer.\n")
    assert session.changed_on_disk() == [document]
    session.diagnostics(document)
    session.imports_changed = False
    assert session.changed_on_disk() == []
    laws.write_text(LAWS)
    # A request of the editor sees the change first.
    assert session.view(document).files[str(laws)] == LAWS
    assert session.changed_on_disk() == [document]
    laws.write_text(LAWS + "// Longer.\n")
    # The editor has sent a notification, and the server has published what it found.
    session.diagnostics(document)
    session.imports_changed = False
    assert session.changed_on_disk() == []
