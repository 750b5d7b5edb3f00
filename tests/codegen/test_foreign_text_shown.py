"""Text from outside in everything that is shown: pictures, pages, diagnostics, recordings, traces, and the output of
commands.
"""

from __future__ import annotations

import csv
import io
import json
import os
import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

from cspdiag import pipeline
from cspdiag.base import SourceFile
from cspdiag.cli.main import main
from cspdiag.cli.support.diagnostic_formats import FORMATS, rendered_diagnostics
from cspdiag.draw.layout.elk import engine_available
from tests.codegen.hostile import FILE_NAMES, TEXTS, program
from tests.codegen.skeleton import html

needs_engine = pytest.mark.skipif(
    not engine_available(), reason="the layout engine is not there: make setup fetches it"
)

ALL = "\n".join(TEXTS.values())
NAME = "".join(name.removesuffix(".csp") for name in FILE_NAMES if "/" not in name) + ".csp"
"""All of it at once."""
UNSEEN = re.compile(r"[\x00-\x08\x0b-\x1f\x7f\x80-\x9f\u2028\u2029\u202a-\u202e\u2066-\u2069\ufeff\ud800-\udfff]")


BAD = "process P { in a : double @ 10 ms  out b : unknown  composition { skip } }\n"


@pytest.fixture
def at(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def written(name: str, text: str) -> str:
    """A file name with that text, as a shell would pass it on."""
    path = name.replace("/", "_")
    Path(path).write_text(text, encoding="utf-8")
    return f"./{path}"


def kinds(document: str) -> set[tuple[str, tuple[str, ...]]]:
    """The elements of a picture, each with the names of its attributes."""
    return {(element.tag, tuple(element.attrib)) for element in ElementTree.fromstring(document).iter()}


def assert_shown(capsys: pytest.CaptureFixture[str]) -> str:
    """The output of a command is visible, and does not control the terminal."""
    reported = "".join(capsys.readouterr())
    assert UNSEEN.search(reported) is None, ascii(reported)
    assert "internal error" not in reported
    return reported


@pytest.mark.parametrize("name", FILE_NAMES)
@pytest.mark.parametrize("format_", FORMATS)
def test_a_diagnostic_in_a_file_of_any_name(format_: str, name: str) -> None:
    found = pipeline.check(
        SourceFile(name=name, text=BAD), lambda path: SourceFile(name=path, text="")
    ).report.diagnostics
    reported = "".join(rendered_diagnostics(found, format_, [name], colour=False))
    assert UNSEEN.search(reported) is None
    match format_:
        case "json":
            assert json.loads(reported)[0]["file"] == name
        case "sarif":
            json.loads(reported)
        case "junit":
            ElementTree.fromstring(reported)
        case "github" | "concise":
            assert len(reported.splitlines()) == len(found)


@needs_engine
@pytest.mark.usefixtures("at")
def test_pictures_and_pages_of_any_text(capsys: pytest.CaptureFixture[str]) -> None:
    for text, file, stem in (("Plain text.", "plain.csp", "plain"), (ALL, NAME, "hostile")):
        path = written(file, program(text))
        assert main(["draw", path, "-o", f"{stem}.svg"]) == 0
        assert main(["draw", path, "--book", f"{stem}.html"]) == 0
    assert_shown(capsys)
    picture = Path("hostile.svg").read_text()
    assert UNSEEN.search(picture) is None
    assert kinds(picture) == kinds(Path("plain.svg").read_text())
    assert "".join(ElementTree.fromstring(picture).itertext()).count("</title></svg>") > 3
    page = Path("hostile.html").read_text()
    assert UNSEEN.search(page) is None
    assert html(page) <= html(Path("plain.html").read_text()) | COMMENT_LINES


COMMENT_LINES = {("span", ("class",)), ("p", ("class",))}


@needs_engine
@pytest.mark.parametrize("format_", ["png", "pdf"])
@pytest.mark.usefixtures("at")
def test_other_pictures_show_any_text(format_: str) -> None:
    assert main(["draw", written("hostile.csp", program(ALL)), "-o", f"hostile.{format_}"]) == 0


@pytest.mark.parametrize("level", ["-O0", "-O1"])
@pytest.mark.usefixtures("at")
def test_a_run_of_a_file_of_any_name(level: str, capsys: pytest.CaptureFixture[str]) -> None:
    text = program(ALL).replace('python "installed.wheel:Wheel"', 'python "wheel.py:Wheel"')
    path = written(NAME, text)
    Path("wheel.py").write_text("class Wheel:\n    def __init__(self, name: str, place: int) -> None: ...\n")
    outputs = ["--record", "out.csv", "--trace", "out.json", "--plot", "out.svg"]
    assert main(["run", path, "--environment", "Bench", "--for", "50ms", level, *outputs]) == 0
    assert_shown(capsys)
    json.loads(Path("out.json").read_text())
    ElementTree.fromstring(Path("out.svg").read_text())
    rows = list(csv.reader(io.StringIO(Path("out.csv").read_text())))
    assert {len(row) for row in rows} == {5}
    assert sorted(os.listdir()) == sorted([NAME, "out.csv", "out.json", "out.svg", "wheel.py"])


@pytest.mark.usefixtures("at")
def test_messages_about_a_file_of_any_name(capsys: pytest.CaptureFixture[str]) -> None:
    path, plain = written(NAME, program(ALL)), written(f"plain {NAME}", program("Plain."))
    bad = written(f"bad {NAME}", BAD)
    commands = [
        ["fmt", "--check", "--diff", plain],
        ["fmt", "--check", path],
        ["fmt", path],
        ["check", bad],
        ["compile", path, "-o", f"{path} build"],
        ["verify", path, "--timing"],
        ["verify", path],
        ["margins", path],
        ["compile", path, "--emit", "model"],
        ["compile", path, "--emit", "network"],
        ["diff", path, path],
        ["check", f"{path} that is missing"],
        ["run", path, "--record", f"{path}/no/folder.csv", "--for", "1ms"],
    ]
    for command in commands:
        main(command)
        assert_shown(capsys)
        assert not Path("executed").exists(), command
