"""Diagrams as editors ask for them: of the text as it is, with the places that their elements represent."""

from __future__ import annotations

import asyncio
import re
from base64 import b64decode
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from lsprotocol import types

from cspdiag.draw.layout import engine
from cspdiag.lsp.pictures.drawn import Request, answer
from cspdiag.lsp.pictures.process import Drawer, DrawingError
from tests.lsp.editor import Client, Editor

pytestmark = [
    pytest.mark.asyncio(loop_scope="module"),
    pytest.mark.skipif(not engine.available(), reason="the layout engine is not there: `make setup` fetches it"),
]
PIPE = """process Source { out values : int composition { mu values ! 1 } }
process Reader { in values : int communication { var last : int } composition { mu values ? last } }
process Pipe {
  communication {
    source : Source
    reader : Reader
    source.values -> reader.values
  }
  composition { source || reader }
}
"""


async def diagram(client: Client, editor: Editor, **wanted: object) -> dict[str, Any]:
    params = {"textDocument": {"uri": editor.document.uri}, **wanted}
    found = await asyncio.wait_for(client.protocol.send_request_async("cspdiag/diagram", params), 30)
    return plain(found)


def plain(found: Any) -> Any:
    """An answer without the classes that the client makes of objects."""
    if isinstance(found, list):
        return [plain(each) for each in found]
    if isinstance(found, SimpleNamespace):
        return {name: plain(each) for name, each in vars(found).items()}
    return {name: plain(each) for name, each in found._asdict().items()} if hasattr(found, "_asdict") else found


def places(found: dict[str, Any]) -> dict[str, list[str]]:
    """The places of the elements by their keys, as lines and columns from 1."""
    return {
        part["key"]: [
            f"{place['range']['start']['line'] + 1}:{place['range']['start']['character'] + 1}"
            for place in part["places"]
        ]
        for part in found["parts"]
    }


async def test_a_diagram_has_the_places_of_its_elements(client: Client, tmp_path: Path) -> None:
    editor = Editor(client, tmp_path)
    assert await editor.open("pipe.csp", PIPE) == []
    found = await diagram(client, editor)
    assert found["name"] == "Pipe"
    assert found["whole"]
    assert [each["name"] for each in found["definitions"]] == ["Source", "Reader", "Pipe"]
    assert places(found) == {
        "source": ["5:5"],
        "reader": ["6:5"],
        "source|values": ["1:22"],
        "reader|values": ["2:21"],
        "source.values -> reader.values": ["7:5"],
        "step-1.1": ["9:17"],
        "step-1.2": ["9:27"],
    }
    assert set(re.findall(r' id="([^"]+)"', found["svg"])) == {"Pipe", *(part["id"] for part in found["parts"])}
    assert {part["inside"] for part in found["parts"]} == {"Source", "Reader", None}
    assert {place["uri"] for part in found["parts"] for place in part["places"]} == {editor.document.uri}
    await editor.close()


async def test_it_is_that_of_the_text_at_the_cursor_and_of_what_is_typed(client: Client, tmp_path: Path) -> None:
    editor = Editor(client, tmp_path)
    await editor.open("pipe.csp", PIPE)
    at = types.Position(1, 30)
    assert (await diagram(client, editor, position={"line": 1, "character": 30}))["name"] == "Reader", at
    assert (await diagram(client, editor, process="Source"))["name"] == "Source"
    assert "there is no `Nobody` to draw" in (await diagram(client, editor, process="Nobody"))["problem"]
    await editor.replace(PIPE.replace("source : Source", "source : Source\n    second : Source"))
    assert "second" in places(await diagram(client, editor))
    await editor.close()


async def test_mistakes_are_marked_and_what_cannot_be_read_is_left_out(client: Client, tmp_path: Path) -> None:
    editor = Editor(client, tmp_path)
    await editor.open("pipe.csp", PIPE.replace("-> reader.values", "-> reader.value"))
    found = await diagram(client, editor)
    assert found["whole"]
    assert "error" in found["svg"]
    await editor.replace(PIPE.replace("source || reader", "source || "))
    broken = await diagram(client, editor)
    assert broken.get("whole") is not True
    await editor.close()


async def test_a_picture_as_a_file(client: Client, tmp_path: Path) -> None:
    editor = Editor(client, tmp_path)
    await editor.open("pipe.csp", PIPE)
    svg = b64decode((await diagram(client, editor, format="svg", scheme="dark"))["data"])
    assert svg.startswith(b"<svg")
    assert b"<style>" in svg
    png = b64decode((await diagram(client, editor, format="png", which="composition"))["data"])
    assert png.startswith(b"\x89PNG")
    await editor.close()


async def test_a_file_that_is_not_open_has_none(client: Client, tmp_path: Path) -> None:
    editor = Editor(client, tmp_path)
    editor.main = "closed.csp"
    assert (await diagram(client, editor))["problem"] == "the file is not open"


async def test_a_file_that_is_too_large_has_none(client: Client, tmp_path: Path) -> None:
    editor = Editor(client, tmp_path)
    await editor.open("large.csp", "const a = 1\n" * 84_000)
    assert (await diagram(client, editor))["problem"] == (
        "this file has 1008000 characters, more than the 1000000 that are checked while they are edited"
    )
    await editor.close()


@pytest.mark.parametrize(
    ("wanted", "problem"),
    [
        ({"which": "nonsense"}, '`which` is communication, composition or both, not "nonsense"'),
        ({"format": "gif"}, '`format` is svg, png or pdf, not "gif"'),
        ({"format": "svg", "scheme": "pink"}, '`scheme` is light, dark or auto, not "pink"'),
    ],
)
async def test_unknown_values_are_refused(
    client: Client, tmp_path: Path, wanted: dict[str, object], problem: str
) -> None:
    editor = Editor(client, tmp_path)
    await editor.open("pipe.csp", PIPE)
    assert (await diagram(client, editor, **wanted))["problem"] == problem
    await editor.close()


async def test_an_import_that_the_server_does_not_read_is_not_drawn_either(client: Client, tmp_path: Path) -> None:
    (tmp_path / "large.csp").write_text("submodel Law { in a : double out b : double b = a }\n" * 100_000)
    editor = Editor(client, tmp_path)
    await editor.open("main.csp", f'import "large.csp"\n{PIPE}')
    assert (await diagram(client, editor))["name"] == "Pipe"
    await editor.close()


async def test_an_import_is_drawn_as_it_is_in_the_editor_under_any_name(client: Client, tmp_path: Path) -> None:
    (tmp_path / "pipe.csp").write_text(PIPE)
    (tmp_path / "same.csp").symlink_to(tmp_path / "pipe.csp")
    editor = Editor(client, tmp_path)
    await editor.open("pipe.csp", PIPE.replace("Pipe", "Tube"))
    main = 'import "same.csp"\nprocess Main { communication { tube : Tube } composition { tube } }\n'
    assert await editor.open("main.csp", main) == []
    assert "fill-error" not in (await diagram(client, editor))["svg"]
    await editor.close()


async def test_of_requests_that_wait_the_latest_is_drawn() -> None:
    drawer = Drawer()
    request = {"main": "pipe.csp", "texts": {"pipe.csp": PIPE}}
    found = await asyncio.gather(*(drawer.draw("pipe", request) for _ in range(5)))
    # The first may have begun before the others came.
    assert [each is None for each in found][1:] == [True, True, True, False]
    assert drawer.drawn <= 2
    await drawer.close()


async def test_a_process_that_ends_is_started_again() -> None:
    drawer = Drawer()
    request = {"main": "pipe.csp", "texts": {"pipe.csp": PIPE}}
    await drawer.draw("pipe", request)
    assert drawer._process is not None
    drawer._process.kill()
    await drawer._process.wait()
    assert (await drawer.draw("pipe", request) or {})["name"] == "Pipe"
    with pytest.raises(DrawingError, match="has ended"):
        await drawer.draw("pipe", {"nothing": "known"})
    assert (await drawer.draw("pipe", request) or {})["name"] == "Pipe"
    await drawer.close()


async def test_a_picture_that_takes_too_long_does_not_delay_others() -> None:
    drawer = Drawer(time_limit=0.01)
    request = {"main": "pipe.csp", "texts": {"pipe.csp": PIPE}}
    with pytest.raises(DrawingError, match=r"too large: it was not drawn within 0\.01 s"):
        await drawer.draw("pipe", request)
    drawer._time_limit = 60
    assert (await drawer.draw("pipe", request) or {})["name"] == "Pipe"
    await drawer.close()


async def test_a_text_without_a_process_has_no_diagram() -> None:
    assert answer(Request("a.csp", {"a.csp": "const a = 1\n"}))["problem"] == "there is no process to draw"
    broken = answer(Request("a.csp", {"a.csp": "process Bad {\n  composition { skip ; ) }\n}\n"}))["problem"]
    assert broken == "the text has mistakes in its syntax, and without what has them there is no process to draw"
