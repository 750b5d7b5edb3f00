"""The engine of a file: it reads the program, and what a program names is found beside it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from cspdiag import load
from cspdiag.cli.main import main
from cspdiag.studio.engine.program_file import ProgramFile
from tests.studio.talking import Talk

ROOT = Path(__file__).parents[2]

PASSING = """\
import "{parts}"
process Pass {{
  in  value : double @ 10 ms
  out level : double @ 10 ms safe 0.0
  communication {{ law : Law  value -> law.value  law.level -> level }}
  composition {{ mu law }}
}}
"""
LAW = 'submodel Law python "law.py:Law" { in value : double  out level : double }\n'


@pytest.fixture(autouse=True)
def own_working_folder(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """The engine changes it."""
    monkeypatch.chdir(tmp_path)


def talk_about(path: Path) -> Talk:
    return Talk(file=ProgramFile(str(path)))


def test_imported_files_and_what_lies_beside_belong_to_the_program(tmp_path: Path) -> None:
    folder = tmp_path / "own programs"
    (folder / "library").mkdir(parents=True)
    texts = {
        "main.csp": 'import "library/parts.csp"\nimport "nothing.csp"\n',
        "library/parts.csp": 'import "../../shared.csp"\n',
        "library/law.py": "class Law: ...\n",
        "main.svg": "<svg/>\n",
        "notes.txt": "not a part of it\n",
    }
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8")
    (tmp_path / "shared.csp").write_text('import "own programs/main.csp"\n', encoding="utf-8")
    talk = talk_about(folder / "main.csp")
    program = talk.ask("hello")["program"]
    assert program["main"] == "own programs/main.csp"
    own = {f"own programs/{name}": text for name, text in texts.items() if name != "notes.txt"}
    assert program["files"] == {"shared.csp": 'import "own programs/main.csp"\n', **own}


def test_hello_has_the_program_as_it_is_now(tmp_path: Path) -> None:
    file = tmp_path / "a.csp"
    file.write_text("// before\n")
    talk = talk_about(file)
    assert talk.ask("hello")["program"] == {"files": {"a.csp": "// before\n"}, "main": "a.csp"}
    file.write_bytes(b"// after\r\n")
    assert talk.ask("hello")["program"]["files"] == {"a.csp": "// after\n"}
    file.unlink()
    assert "a.csp: No such file" in talk.refused("hello")


def test_bodies_outside_of_the_folder_of_the_file_are_found(tmp_path: Path) -> None:
    (tmp_path / "laws").mkdir()
    (tmp_path / "program").mkdir()
    main_file = tmp_path / "program" / "main.csp"
    main_file.write_text(PASSING.format(parts="../laws/laws.csp"))
    (tmp_path / "laws" / "laws.csp").write_text(LAW)
    (tmp_path / "laws" / "law.py").write_text("class Law:\n    def calculate(self, value):\n        return value\n")
    talk = talk_about(main_file)
    program = talk.ask("hello")["program"]
    assert program["main"] == "program/main.csp"
    assert talk.ask("check", **program)["diagnostics"] == []
    # A page need not send what it does not show.
    files = {name: text for name, text in program["files"].items() if name.endswith(".csp")}
    compiled = talk.ask("compile", files=files, main=program["main"], target="python")["files"]
    assert any(path.endswith("external/law.py") for path in compiled)


LOOP = """\
import "tank.csp"

submodel Plant fmu "../plants/tank_bench.fmu" {}

environment AsFmu for Tank {
  plant : Plant

  opening     -> plant.opening
  plant.level -> level
}
"""


def test_a_program_with_an_fmu_beside_it_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("fmpy")
    monkeypatch.setenv("CFLAGS", "-O0")
    page = (ROOT / "docs" / "fmi.md").read_text(encoding="utf-8")
    own = tmp_path / "programs"
    own.mkdir()
    (own / "tank.csp").write_text(page.split("```csp\n")[1].split("```")[0])
    (own / "loop.csp").write_text(LOOP)
    options = ["--target", "fmu", "--environment", "Bench", "-o", str(tmp_path / "plants")]
    assert main(["compile", str(own / "tank.csp"), *options]) == 0
    talk = talk_about(own / "loop.csp")
    program: dict[str, Any] = talk.ask("hello")["program"]
    assert talk.ask("check", **program)["diagnostics"] == []
    found = talk.ask("run", **program, environment="AsFmu", until="300 ms")
    session = talk.ask("start", **program, environment="AsFmu", until="300 ms")["session"]
    while talk.notifications == [] or talk.notifications[-1]["method"] != "ended":
        talk.ask("step", session=session, by="instant")
    expected = load(own / "loop.csp").run("Bench", until="300 ms")
    shown = [
        value for each in talk.notifications for value in each["params"].get("signals", {}).get("level", {"v": []})["v"]
    ]
    assert found["signals"]["level"]["v"] == shown == list(expected["level"])
    assert len(shown) > 20


WATCH = """\
import "../shared.csp"
process Double {
  in  value : double @ 10 ms
  out level : double @ 10 ms safe 0.0
  communication { var x : double = 0 }
  composition { mu (value ? x ; level ! 2 * x) }
}
submodel Wave { out value : double  value = time / 1<s> }
environment Bench for Double { wave : Wave  wave.value -> value  level -> _ }
"""


def test_a_recording_beside_the_program_gives_its_inputs(tmp_path: Path) -> None:
    own = tmp_path / "own"
    own.mkdir()
    (tmp_path / "shared.csp").write_text("const nothing = 0\n")
    (own / "watch.csp").write_text(WATCH)
    run = ["run", str(own / "watch.csp"), "--for", "200 ms", "--quiet", "--record"]
    assert main([*run, str(own / "bench.csv")]) == 0
    # The program has changed since.
    (own / "watch.csp").write_text(WATCH.replace("time / 1<s>", "7.0").replace("2 * x", "3 * x"))
    talk = talk_about(own / "watch.csp")
    hello = talk.ask("hello")
    assert hello["recordings"] == ["own/bench.csv"]
    program = hello["program"]
    session = talk.ask("start", **program, inputs="own/bench.csv")["session"]
    while talk.notifications == [] or talk.notifications[-1]["method"] != "ended":
        talk.ask("step", session=session, by="instant")
    assert talk.notifications[-1]["params"]["at"] == 200_000_000
    frames = [each["params"]["signals"] for each in talk.notifications if each["method"] == "frame"]
    values = [value for frame in frames for value in frame.get("level", {"v": []})["v"]]
    assert values[:3] == [3 * 0.01, 3 * 0.02, 3 * 0.03]
    assert "its own time" in talk.refused("start", **program, inputs="own/bench.csv", real_time=True)
    assert "No such file" in talk.refused("start", **program, inputs="own/none.csv")
