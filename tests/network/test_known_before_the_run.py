"""What a program starts with is computed before it runs: a value that does not exist is an error of the program, not a
fault of the run.
"""

from __future__ import annotations

import pytest

from cspdiag import pipeline
from cspdiag.base import SourceFile
from tests.conformance.targets import READABLE, REFERENCE, TARGETS

LAW = """
submodel Law(k: int8, word: int, size: double) {{
  in  u : int8
  out y : int8
  {}
}}
submodel Inner(k: int8) {{
  in  u : int8 = k + k
  out y : int8
  y = u + k
}}
submodel Pair(k: int8) {{
  in  u[2] : int8
  out y    : int8
  y = u[0] + u[1] + k
}}
process Main(k: int8 = 100, word: int = 3, size: double = 1e300) {{
  in  u : int8
  out y : int8
  communication {{ law : Law(k, word, size)  u -> law.u  law.y -> y }}
  composition {{ law }}
}}
"""

PROCESS = """
process Inner(k: int8, word: int) {{
  in  u : int8{}
  out y : int8
  communication {{ {} }}
  composition {{ y ! k }}
}}
process Main(k: int8 = 100, word: int = 3, size: double = 1e300) {{
  out y : int8
  communication {{ inner : Inner({}, word)  inner.y -> y }}
  composition {{ inner }}
}}
"""


def found(text: str) -> list[tuple[str, str]]:
    """The errors of a program that is checked, with the texts that they mark; compiling it finds no others."""
    source = SourceFile(name="case.csp", text=text)
    reports = [pipeline.check(source, lambda _: source).report, pipeline.build(source, lambda _: source).checked.report]
    checked, built = (
        [(d.code, d.span.text) for d in report.diagnostics if d.severity == "error"] for report in reports
    )
    assert checked == built
    return checked


@pytest.mark.parametrize(
    ("items", "code", "place"),
    [
        ("state s : int8 = k + k  next s = u  y = s", "E0902", "k + k"),
        ("state s : double = size * size  next s = 0  y = if s > 0 then u else k", "E0902", "size * size"),
        ("state s : int = 1 / (word - 3)  next s = 0  y = if s > 0 then u else k", "E0903", "1 / (word - 3)"),
        ("y = pre(u, -k - k)", "E0902", "-k - k"),
        ("y = delay(u, 1 / (word - 3), k)", "E0903", "1 / (word - 3)"),
        ("inner : Inner(k)  y = inner.y", "E0902", "k + k"),
        ("inner : Inner(k * k)  inner.u = u  y = inner.y", "E0902", "k * k"),
        ("inner[3] : Inner(int8(1))  y = inner[word].y", "E0503", "word"),
        ("inner[3] : Inner(int8(1))  inner[word].u = u  y = inner[0].y", "E0503", "word"),
        ("pair : Pair(k)  pair.u[0] = u  pair.u[word] = u  y = pair.y", "E0503", "word"),
        ("pair : Pair(k)  pair.u[0] = u  y = pair.y", "E0406", "Law"),
    ],
)
def test_law(items: str, code: str, place: str) -> None:
    assert found(LAW.format(items)) == [(code, place)]


def test_elements_of_outputs_of_a_law() -> None:
    text = LAW.replace("out y : int8\n  {}", "out y[2] : int8\n  {}").replace(
        "law.y -> y", "law.y[0] -> y law.y[1] -> _"
    )
    assert found(text.format("y[0] = u  y[word] = u")) == [("E0503", "word")]
    assert found(text.format("y[0] = u")) == [("E0401", "y[2]")]
    assert found(text.format("y[0] = u  y[word - 2] = u")) == []


@pytest.mark.parametrize(
    ("default", "declarations", "argument", "code", "place"),
    [
        (" = 0", "var v : int8 = k + k", "k", "E0902", "k + k"),
        (" = 0", "var v : double = 1 / double(word - 3)", "k", "E0903", "1 / double(word - 3)"),
        (" = 0", "var v : int[2] = [[1, 2], [3, 4]][word]", "k", "E0904", "word"),
        (" = 0", "for i < 3 { var v : int8 = k * int8(i) }", "k", "E0902", "k * int8(i)"),
        (" = k + k", "var v : int8 = 0", "k", "E0902", "k + k"),
        (" = 0", "var v : int8 = 0", "k + k", "E0902", "k + k"),
    ],
)
def test_process(default: str, declarations: str, argument: str, code: str, place: str) -> None:
    assert found(PROCESS.format(default, declarations, argument)) == [(code, place)]


ENVIRONMENT = """
submodel Plant(k: int) {{
  in  u : double
  out y : double
  state s : double = double(1 / k)
  next s = u
  y = s
}}
process Main(k: int8) {{
  in  a : double @ 1 ms
  out b : double @ 1 ms
  communication {{ var v : double }}
  composition {{ mu (a ? v ; b ! v) }}
}}
environment Bench for Main({}) {{ plant : Plant({})  b -> plant.u  plant.y -> a }}
"""


@pytest.mark.parametrize(
    ("argument", "inside", "expected"),
    [
        ("100", "1", []),
        ("int8(100) + int8(100)", "1", [("E0902", "int8(100) + int8(100)")]),
        ("100", "0", [("E0903", "1 / k")]),
        ("100", "1 / (3 - 3)", [("E0903", "1 / (3 - 3)")]),
    ],
)
def test_environment(argument: str, inside: str, expected: list[tuple[str, str]]) -> None:
    assert found(ENVIRONMENT.format(argument, inside)) == expected


def test_each_instance_of_a_law_counts() -> None:
    text = LAW.replace("law : Law(k, word, size)", "law : Law(1, 5, size)  other : Law(2, 3, size)  other.y -> _")
    text = text.replace("u -> law.u", "u -> law.u, other.u").replace("{{ law }}", "{{ law ; other }}")
    assert found(text.format("state s : int = 1 / (word - 3)  next s = 0  y = if s > 0 then u else k")) == [
        ("E0903", "1 / (word - 3)")
    ]
    assert found(text.format("state s : int = 1 / (word - 2)  next s = 0  y = if s > 0 then u else k")) == []


STEPS = """
const none = 0
const large = 9223372036854775807
process Main(k: int = 0) {{
  in  c : int
  out o : double
  out n : int
  communication {{ var a : int8 = 1  var own : int[3] = [1, 2, 3]  c -> _ }}
  composition {{ {} }}
}}
"""


@pytest.mark.parametrize(
    ("step", "marked"),
    [
        ("o ! 1.0 / 0.0", "1.0 / 0.0"),
        ("o ! sqrt(-1.0)", "sqrt(-1.0)"),
        ("o ! 0.0 ^ -1.0", "0.0 ^ -1.0"),
        ("n ! large + 1", "large + 1"),
        ("a := int8(200)", "int8(200)"),
        ("a := 100 + 100", "100 + 100"),
        ("n ! own[3]", "3"),
        ("own[none - 1] := 7", "none - 1"),
        ("a := a % int8(none)", "a % int8(none)"),
        ("wait 9000000 s * 9000000", "9000000 s * 9000000"),
        ("(after 9000000 s * 9000000 -> skip [] after 1 ms -> skip)", "9000000 s * 9000000"),
        ("(stop interrupt n ! 1 / none -> skip)", "1 / none"),
        ("if 1 / none == 1 then n ! 1", "1 / none"),
        ("(while 1 / none == 1 do n ! 1)", "1 / none"),
        ("(mu n ! 1 until 1 / none == 1)", "1 / none"),
        ("(when 1 / none == 1 & skip -> n ! 1)", "1 / none"),
        ("(if a > 0 then n ! 1 / none)", None),
        ("o ! limit(1e300 * 1e300, 0.0, 1.0)", None),
        ("n ! 1 / k", None),
    ],
)
@pytest.mark.parametrize("around", ["{}", "({}) catch Fault -> skip"])
def test_constants_that_fault_in_a_run_are_not_errors(step: str, marked: str | None, around: str) -> None:
    """Such steps fault where they are, which is reported if nothing decides whether they are reached."""
    source = SourceFile(name="case.csp", text=STEPS.format(around.format(step)))
    report = pipeline.build(source, lambda _: source).checked.report
    assert not report.has_errors
    assert [d.span.text for d in report.diagnostics if d.code == "W0907"] == ([] if marked is None else [marked])


def test_an_error_is_not_also_reported_as_a_fault() -> None:
    """Coefficients are in an equation, but are computed before the run."""
    text = LAW.format("y = delay(u, 1 / 0, int8(1))")
    source = SourceFile(name="case.csp", text=text)
    assert [d.code for d in pipeline.check(source, lambda _: source).report.diagnostics] == ["E0903"]


def test_what_is_not_given_is_not_known() -> None:
    """A process of a library may be given other values than its defaults, and a parameter without a value has none."""
    text = PROCESS.format(" = 0", "var v : int8 = k + k", "k").replace("k: int8 = 100, word", "k: int8, word")
    source = SourceFile(name="case.csp", text=text)
    assert not pipeline.check(source, lambda _: source).report.has_errors


def test_default_of_a_port_may_use_parameters() -> None:
    """A default is computed from the values of the instance, whatever the parameters of the process around it are
    called.
    """
    text = """
process Inner(k: int) {
  in  u : int = 2 * k
  out y : int
  communication { var v : int = 0 }
  composition { u ? v ; y ! v }
}
submodel Law(k: int) {
  in  u : int = 3 * k
  out y : int
  y = u
}
process Main {
  out y : int
  communication { one : Inner(5)  two : Inner(k = 7)  law : Law(11)  one.y, two.y, law.y -> y }
  composition { one ; two ; law }
}
environment Bench for Main { y -> _ }
"""
    source = SourceFile(name="case.csp", text=text)
    network = pipeline.build(source, lambda _: source).network
    assert network is not None
    for target in (REFERENCE, READABLE, TARGETS["python-O1"]):
        assert [value for *_, value, _, _ in target.run(network, None, 10).trace] == [10, 14, 33]
