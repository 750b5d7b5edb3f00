"""What an edit costs is counted, not timed: texts that are parsed, programs that are looked into, what is kept."""

from __future__ import annotations

import gc
from pathlib import Path

from cspdiag.editing.view import View
from cspdiag.lsp.documents import Document
from cspdiag.lsp.session import Session
from tests.lsp.everything import ask

LAWS = "const gain = 2\n"
MAIN = 'import "laws.csp"\nimport std.control\n\nconst twice = 2 * gain\n'


def opened(session: Session, folder: Path) -> Document:
    (folder / "laws.csp").write_text(LAWS)
    return session.documents.open((folder / "main.csp").as_uri(), MAIN, 1)


def retyped(session: Session, document: Document, text: str) -> Document:
    return session.documents.open(document.uri, text, None)


def test_an_edit_parses_only_the_file_that_was_edited(tmp_path: Path) -> None:
    session = Session()
    document = opened(session, tmp_path)
    assert session.diagnostics(document) == []
    parses, views = session.parses, session.views
    for number in range(20):
        document = retyped(session, document, f"{MAIN}// {number}\n")
        assert session.diagnostics(document) == []
    assert (session.parses - parses, session.views - views) == (20, 20)


def test_requests_between_edits_share_what_is_known(tmp_path: Path) -> None:
    session = Session()
    document = opened(session, tmp_path)
    session.diagnostics(document)
    parses, views = session.parses, session.views
    for offset in range(len(MAIN)):
        ask(session, document, offset)
    assert (session.parses, session.views) == (parses, views)


def test_an_edit_of_an_import_is_seen_by_the_file_that_imports_it(tmp_path: Path) -> None:
    session = Session()
    document = opened(session, tmp_path)
    session.diagnostics(document)
    parses = session.parses
    laws = session.documents.open((tmp_path / "laws.csp").as_uri(), "const other = 2\n", 1)
    assert session.diagnostics(laws) == []
    assert [found.code for found in session.diagnostics(document)] == ["E0204"]
    assert session.parses - parses == 1


def test_a_change_of_an_import_that_is_taken_back_leaves_places_as_they_were(tmp_path: Path) -> None:
    session = Session()
    text = LAWS + "const other = gain\n"
    place = text.index("other"), text.index("other") + len("other")
    laws = session.documents.open((tmp_path / "laws.csp").as_uri(), text, 1)
    document = session.documents.open((tmp_path / "main.csp").as_uri(), MAIN, 1)
    for change in ("", "// Moved.\n"):
        laws = retyped(session, laws, change + text)
        session.diagnostics(laws)
        laws = retyped(session, laws, text)
        found = session.view(document).program.definitions["other"].name.span
        assert (found.start, found.end) == place


def test_names_are_known_before_the_checks(tmp_path: Path) -> None:
    session = Session()
    view = session.view(opened(session, tmp_path))
    assert view.here.at(MAIN.index("gain")) is not None
    assert "checked" not in vars(view)


def test_what_edits_leave_is_garbage(tmp_path: Path) -> None:
    session = Session()
    document = opened(session, tmp_path)
    for number in range(30):
        document = retyped(session, document, f"{MAIN}// {number}\n")
        ask(session, document, number)
    gc.collect()
    assert sum(isinstance(item, View) for item in gc.get_objects()) <= 1
    assert session.remembered == 2
