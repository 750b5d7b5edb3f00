"""What the engine answers about a text: diagnostics, completion, diagrams, proofs, runs, packages."""

import json
import re
import subprocess
import sys

import pytest

from cspdiag import load
from tests.studio.talking import JIWY, Talk, program
from tests.support.lacking import without_numpy

DELAY = """\
/// Passes values on.
process Delay {
  in  input  : double<rad> @ 1 ms
  out output : double<rad> safe 0<rad>

  communication { var x : double<rad> = 0<rad> }
  composition { mu (input ? x ; output ! x) }
}

submodel Wave {
  out value : double<rad>
  value = sin(time / 1<s>) * 1<rad>
}

submodel Sink { in value : double<rad> }

environment Bench for Delay {
  wave : Wave
  sink : Sink
  wave.value -> input
  output -> sink.value
}
assert Delay deadlock free
"""


def test_hello_says_who_it_is_and_has_the_models(talk: Talk) -> None:
    found = talk.ask("hello")
    assert (found["engine"], found["able"]["numpy"]) == ("machine", True)
    names = [model["name"] for model in found["models"]]
    assert names[:2] == ["jiwy", "jiwy/stolen_button"]
    assert "dining/deadlock" in names
    assert "jiwy/plant" not in names
    for model in found["models"]:
        assert model["main"] in model["files"]
        assert model["title"]


@pytest.mark.parametrize("name", ["jiwy", "dining/deadlock", "emergency", "jiwy_mujoco"])
def test_models_have_no_mistakes(talk: Talk, name: str) -> None:
    assert talk.ask("check", **talk.model(name))["diagnostics"] == []


def test_check_tells_what_the_program_has(talk: Talk) -> None:
    found = talk.ask("check", **talk.model("jiwy"))
    assert found["top"] == "Jiwy"
    assert [environment["name"] for environment in found["environments"]] == ["Bench", "Worn", "Gamepad"]
    assert found["environments"][0]["outputs"] == ["control_horizontal", "control_vertical"]
    paths = [process["path"] for process in found["processes"]]
    assert paths[:3] == ["Jiwy", "Jiwy.horizontal", "Jiwy.vertical"]
    assert "Jiwy.vertical.motionControl" in paths
    assert [parameter["type"] for parameter in found["parameters"]] == ["ServoGains", "ServoGains"]
    assert found["assertions"][0]["text"] == "assert Jiwy deadlock free"


def test_check_names_what_is_in_other_languages(talk: Talk) -> None:
    submodel = "in u : double out y : double }\n"
    files = {
        "main/p.csp": f'import "../parts/laws.csp"\nsubmodel A python "subprocess:Popen" {{ {submodel}',
        "parts/laws.csp": f'submodel B python "law.py:Law" {{ {submodel}submodel C c "law.c" {{ {submodel}'
        'driver D device "udp" { out x : double }\n',
    }
    found = talk.ask("check", files=files, main="main/p.csp")["bodies"]
    assert {(each["language"], each["target"], *each["files"]) for each in found} == {
        ("python", "subprocess:Popen"),
        ("python", "law.py:Law", "parts/law.py"),
        ("c", "law.c", "parts/law.c", "parts/law.h"),
        ("device", "udp"),
    }


def test_a_diagnostic_has_its_places_and_its_correction(talk: Talk) -> None:
    (found,) = talk.ask("check", **program(DELAY.replace("input ? x ;", "inptu ? x ;")))["diagnostics"]
    assert (found["severity"], found["code"]) == ("error", "E0204")
    line = DELAY.splitlines().index("  composition { mu (input ? x ; output ! x) }")
    assert found["place"] == {
        "file": "p.csp",
        "start": {"line": line, "character": 20},
        "end": {"line": line, "character": 25},
    }
    assert "input" in found["help"]
    assert talk.ask("explain", code=found["code"])["markdown"].startswith("A name")


def test_characters_count_as_in_the_page(talk: Talk) -> None:
    text = "/* 😀 */ process P {"
    place = talk.ask("check", **program(text))["diagnostics"][0]["place"]
    assert place["end"]["character"] <= len(text.encode("utf-16-le")) // 2
    found = talk.ask("hover", **program("/* 😀 */ process Pot {}"), place={"line": 0, "character": 19})
    assert found["place"]["start"] == {"line": 0, "character": 17}


def test_a_program_with_mistakes_has_what_could_be_read(talk: Talk) -> None:
    found = talk.ask("check", **program(DELAY.replace("out output", "out output out")))
    assert found["diagnostics"][0]["severity"] == "error"
    assert found["environments"][0]["name"] == "Bench"


def test_a_correction_is_applied_by_its_edits(talk: Talk) -> None:
    text = "process P {\n  composition { skip ; ; skip }\n}\n"
    fixable = talk.ask("check", **program(DELAY.replace("mu (input", "mu  input").replace("x) }", "x }")))
    assert all(set(fix) == {"title", "edits"} for found in fixable["diagnostics"] for fix in found["fixes"])
    assert talk.ask("check", **program(text))["diagnostics"]


def test_completion_hover_and_definition(talk: Talk) -> None:
    lines = DELAY.splitlines()
    line = lines.index("  wave : Wave")
    found = talk.ask("complete", **program(DELAY), place={"file": "p.csp", "line": line, "character": 11})
    labels = {item["label"]: item for item in found}
    assert labels["Wave"]["kind"] == "function"
    assert labels["Wave"]["start"] == {"line": line, "character": 9}
    at = {"file": "p.csp", "line": line, "character": 10}
    assert "submodel Wave" in talk.ask("hover", **program(DELAY), place=at)["markdown"]
    (place,) = talk.ask("definition", **program(DELAY), place=at)
    assert place["start"]["line"] == lines.index("submodel Wave {")
    assert talk.ask("hover", **program(DELAY), place={"line": 0, "character": 0}) is None


def test_format(talk: Talk) -> None:
    assert talk.ask("format", text="process  P{}") == {"text": "process P {\n}\n"}
    assert "mistakes" in talk.refused("format", text="process {")


def test_elements_of_a_diagram_lead_to_the_text_and_to_runs(talk: Talk) -> None:
    pytest.importorskip("quickjs")
    model = talk.model("jiwy")
    found = talk.ask("draw", **model, depth=2)
    by_path = {element["path"]: element for element in found["elements"] if "path" in element}
    assert by_path["Jiwy.horizontal"]["unfolded"]
    assert by_path["Jiwy.horizontal.alignL"]["places"][0]["file"] == "jiwy.csp"
    assert all(f'id="{element["id"]}"' in found["svg"] for element in found["elements"])
    carried = {channel for element in found["elements"] for channel in element.get("channels", [])}
    assert {"Jiwy.control_vertical", "Jiwy.horizontal.leftmax"} <= carried
    inner = talk.ask("draw", **model, of="Jiwy.horizontal", view="composition")
    assert next(element["path"] for element in inner["elements"] if "path" in element) == "Jiwy.horizontal.alignL"
    assert "no process" in talk.refused("draw", **model, of="Nothing")


def test_a_program_with_mistakes_is_drawn(talk: Talk) -> None:
    pytest.importorskip("quickjs")
    found = talk.ask("draw", **program(DELAY.replace("input ? x ;", "inptu ? x ;")))
    assert found["svg"].startswith("<svg")


def test_a_counterexample_is_a_film(talk: Talk) -> None:
    (answer, livelock) = talk.ask("verify", **talk.model("dining/deadlock"))
    assert (answer["verdict"], livelock["verdict"]) == ("fails", "holds")
    film = answer["counterexample"]
    first = next(step for step in film["steps"] if step["kind"] == "communication")
    assert first["writer"] == "SymmetricTable.philosopher[0]"
    assert first["channel"] == "SymmetricTable.philosopher[0].first"
    assert len(film["final"]["ring"]) == 10
    assert film["final"]["waiting"][0]["channels"]
    edits = answer["suggestion"]["edits"]
    assert edits[0]["place"]["file"] == "deadlock.csp"


def test_what_is_asserted_holds(talk: Talk) -> None:
    (answer,) = talk.ask("verify", **program(DELAY), only="assert Delay deadlock free")
    assert answer["verdict"] == "holds"
    assert "errors" in talk.refused("verify", **program("process P { in a : nothing }"))


def test_timing(talk: Talk) -> None:
    found = talk.ask("timing", **talk.model("jiwy"))
    assert found["text"].startswith("SCHEDULABLE")
    assert len(found["rows"]) == 8


def test_a_run_is_that_of_the_command(talk: Talk, tmp_path) -> None:
    found = talk.ask("run", **talk.model("jiwy"), until="300 ms", set={"Tsh": "4 ms"})
    expected = load(JIWY).run(until="300 ms", set={"Tsh": "4 ms"})
    expected.to_csv(tmp_path / "run.csv")
    assert found["csv"] == (tmp_path / "run.csv").read_text()
    assert found["ended"] == "until"
    signal = found["signals"]["control_vertical"]
    assert signal["unit"] == "V"
    assert signal["v"] == list(expected["control_vertical"])
    assert signal["t"] == [round(time * 1e9) for time in expected.time("control_vertical")]


def test_a_run_that_deadlocks_says_who_waits(talk: Talk) -> None:
    found = talk.ask("run", **talk.model("dining/deadlock"))
    assert found["ended"] == "deadlock"
    assert "10 processes wait for each other" in found["text"]


@pytest.mark.parametrize("target", ["python", "c", "fmu", "promela", "cspm"])
def test_packages(talk: Talk, target: str) -> None:
    assert talk.ask("compile", **program(DELAY), target=target)["files"]


@pytest.mark.parametrize(
    ("method", "params", "words"),
    [
        ("nothing", {}, "there is no request 'nothing'"),
        ("check", {}, "`files`"),
        ("check", {"files": {"a.csp": 3}, "main": "a.csp"}, "`files`"),
        ("check", {"files": {"a.csp": ""}, "main": "b.csp"}, "`main`"),
        ("check", {"files": {"../a.csp": ""}, "main": "../a.csp"}, "not a name of a file"),
        ("check", {"files": {"/etc/passwd": ""}, "main": "/etc/passwd"}, "not a name of a file"),
        ("check", {"files": {"a.csp": "\0"}, "main": "a.csp"}, "zero bytes"),
        ("check", {"files": {"a.csp": "x" * 1_000_001}, "main": "a.csp"}, "more than the 1000000"),
        ("hover", program(DELAY), "`place`"),
        ("hover", {**program(DELAY), "place": {"line": "x"}}, "`place`"),
        ("hover", {**program(DELAY), "place": {"file": "q.csp", "line": 0, "character": 0}}, "no file 'q.csp'"),
        ("draw", {**program(DELAY), "depth": 99}, "`depth`"),
        ("draw", {**program(DELAY), "view": "other"}, "`view`"),
        ("run", {**program(DELAY), "until": "never"}, "never"),
        ("run", {**program(DELAY), "environment": "Moon"}, "no environment `Moon`"),
        ("run", {**program(DELAY), "set": {"nothing": 1}}, "nothing"),
        ("run", {**program(DELAY), "set": 4}, "`set`"),
        ("run", program("process P { in a : nothing }"), "errors"),
        ("compile", {**program(DELAY), "target": "cobol"}, "cobol"),
        ("compile", {**program(DELAY), "level": "x"}, "level"),
        ("verify", {**program(DELAY), "only": "assert Moon"}, "asserts no"),
        ("verify", {**program(DELAY), "time_limit": "x"}, "`time_limit`"),
        ("explain", {"code": "E9999"}, "no diagnostic"),
    ],
)
def test_what_is_wrong_in_a_request_is_said(talk: Talk, method: str, params: dict, words: str) -> None:
    message = talk.refused(method, **params)
    assert words in message
    assert "cspdiag failed" not in message


def test_requests_that_are_none_are_refused(talk: Talk) -> None:
    for message in (None, 3, [], "check", {"method": ["check"]}, {"method": "check", "params": 3}):
        assert "error" in talk.engine.request(message)  # type: ignore[arg-type]


def test_no_file_of_the_machine_is_read(talk: Talk, tmp_path) -> None:
    (tmp_path / "secret.csp").write_text("const secret = 1\n")
    (found,) = talk.ask("check", **program(f'import "{tmp_path}/secret.csp"\n'))["diagnostics"]
    assert "not among the files" in found["message"] + str(found["help"])


def test_on_standard_input_and_output_a_message_is_a_line() -> None:
    requests = [{"id": 1, "method": "format", "params": {"text": "process P{}"}}]
    text = "".join(json.dumps(each) + "\n" for each in requests) + "nonsense\n"
    done = subprocess.run(
        [sys.executable, "-m", "cspdiag.studio.engine"], input=text, capture_output=True, text=True, check=True
    )
    first, second = map(json.loads, done.stdout.splitlines())
    assert first == {"id": 1, "result": {"text": "process P {\n}\n"}}
    assert "error" in second


def test_the_engine_needs_no_package_of_editors() -> None:
    text = (
        "import sys; from cspdiag.studio.engine.engine import Engine; e = Engine(print); "
        "p = {'files': {'a.csp': 'process P {}'}, 'main': 'a.csp', 'place': {'line': 0, 'character': 9}}; "
        "[e.request({'id': 1, 'method': m, 'params': p}) for m in ('check', 'complete', 'hover', 'definition')]; "
        "print([name for name in ('lsprotocol', 'pygls', 'numpy', 'asyncio') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"


HELD = """\
submodel Lag {
  in  u : double
  out y : double
  y = transfer([1.0], [1.0, 2.0, 1.0], u, method = zoh)
}
process Main {
  in  input  : double @ 1 ms
  out output : double safe 0.0
  communication {
    lag : Lag
    input -> lag.u
    lag.y -> output
  }
  composition { mu lag }
}
"""


def test_margins(talk: Talk) -> None:
    found = talk.ask("margins", **talk.model("jiwy"), environment="Bench")
    assert "closed loop" in found["text"]
    assert {loop["stable"] for loop in found["report"]["loops"]} == {True}
    assert "no environment" in talk.refused("margins", **program("process A {\n  composition { skip }\n}\n"))
    with without_numpy():
        refused = Talk().answer("margins", **talk.model("jiwy"))["error"]
    assert "numpy" in refused["message"]
    assert "on a machine" in refused["help"]


def test_what_an_engine_cannot_discretize_is_marked_and_the_rest_is_drawn() -> None:
    with without_numpy():
        without = Talk()
        (found,) = without.ask("check", **program(HELD))["diagnostics"]
        assert (found["code"], found["place"]["start"]["line"]) == ("E0462", 3)
        assert "E0462 discretizing `transfer` by zoh needs the package numpy" in without.refused(
            "compile", **program(HELD)
        )
        assert without.ask("draw", **program(HELD), view="communication")["elements"]


def test_an_error_of_the_program_is_named_in_one_sentence(talk: Talk) -> None:
    text = "process A {\n  composition { missing ; other }\n}\n"
    for method in ("compile", "run", "timing", "start"):
        said = talk.refused(method, **program(text))
        assert re.fullmatch(r"the program has errors: E\d+ [^\n]*, p\.csp:2 \(and 1 more\)", said), said
