"""Delays that are certain to end immediately take no time in any rule; delays that may last longer count as waiting."""

from __future__ import annotations

import pytest

from cspdiag import pipeline
from cspdiag.base import SourceFile

PROGRAM = """
const T = 2 ms
process Part(d: time, n: int = 3) {{
  out o : int
  composition {{ {part} }}
}}
process Raising {{
  composition {{ raise Stop }}
}}
process Main(longest: time = 5 ms) {{
  in  e : int
  in  x : double @ 2 ms
  out o : int
  out light : bool @ 2 ms
  communication {{
    part[2] : Part({arguments})
    raising : Raising
    var v : time = 0 ms
    var w : int = 0
    var y : double = 0
    part[0].o, part[1].o -> o
  }}
  composition {{
    (part[0] ; part[1] ; {body} ; light ! v > longest ; (e ? w) ; (x ? y) ; raising) catch Stop -> skip
  }}
}}
exception Stop
"""


def codes(part: str = "o ! n", arguments: str = "1 ms", body: str = "skip") -> list[str]:
    """The diagnostics of loops, branches and samples in a program."""
    source = SourceFile(name="case.csp", text=PROGRAM.format(part=part, arguments=arguments, body=body))
    found = [d.code for d in pipeline.check(source, lambda _: source).report.diagnostics]
    assert not {"E0101", "E0201", "E0301"} & set(found)
    return [code for code in found if code in ("E0610", "E0612", "W0613", "W0615")]


@pytest.mark.parametrize(
    "body",
    [
        "mu wait 0 ms",
        "mu wait T - 2 ms",
        "mu wait 3 * (T - T)",
        "mu (light ! true ; wait min(0 ms, T))",
        "mu (wait 0 ms || wait 0 ms)",
        "mu (after 0 ms -> skip)",
        "mu (after 0 ms -> skip [] e ? w -> skip)",
        "mu (e ? w -> skip []> light ! true -> skip)",
        "mu ((wait 1 s) interrupt after 0 ms -> skip)",
        "mu ((x ? y ; wait 1 s) interrupt skip -> wait 0 ms)",
        "mu ((wait 1 s) interrupt light ! true -> skip)",
        "while w > 0 do wait 0 ms",
    ],
)
def test_a_loop_of_zero_delays_is_refused(body: str) -> None:
    assert "E0612" in codes(body=body)


@pytest.mark.parametrize(
    "body",
    [
        "mu wait 1 ns",
        "mu wait v",
        "mu wait v - v",
        "mu wait longest - 4 ms",
        "mu (wait 0 ms ; wait 1 ms)",
        "mu (wait 0 ms || wait 1 ms)",
        "mu (w := w + 1 ; wait 0 ms) until w > 3",
        "mu (after v -> skip [] e ? w -> skip)",
        "mu (after 0 ms -> wait 1 ms [] e ? w -> skip)",
        "mu (e ? w -> wait 1 ms []> after 0 ms -> skip)",
        "mu (when w > 0 & after 0 ms -> skip [] e ? w -> skip)",
        "mu ((wait 1 s) interrupt after 1 ms -> skip)",
        "mu ((wait 1 s) interrupt after v -> skip)",
        "mu ((wait 1 s) interrupt when w > 0 & after 0 ms -> skip)",
        "mu ((raising ; wait 1 s) interrupt after 0 ms -> skip)",
        "mu ((wait 1 s) interrupt after 0 ms -> wait 1 ms)",
    ],
)
def test_a_loop_that_may_take_time_is_not_refused(body: str) -> None:
    assert "E0612" not in codes(body=body)


@pytest.mark.parametrize(
    ("part", "arguments", "is_refused"),
    [
        ("mu wait d", "0 ms", True),
        ("mu wait -d", "1 ms", True),
        ("mu wait d - n * 1 ms", "3 ms", True),
        ("mu wait d - n * 1 ms", "d = 3 ms, n = 2", False),
        ("mu wait d", "1 ms", False),
        ("mu wait n * 1 ms - d", "d = 5 ms, n = 4", True),
    ],
)
def test_parameters_have_the_values_of_the_instances(part: str, arguments: str, is_refused: bool) -> None:
    assert ("E0612" in codes(part=f"(o ! 1 ; {part})", arguments=arguments)) is is_refused


@pytest.mark.parametrize(("given", "is_refused"), [("i * 1 ms", False), ("i * 0 ms", True), ("-i * 1 ms", True)])
def test_one_instance_that_waits_is_enough(given: str, is_refused: bool) -> None:
    """Elements of an array are given the values of their index."""
    text = PROGRAM.format(part="(o ! n ; mu wait d)", arguments="1 ms", body="skip")
    source = SourceFile(name="case.csp", text=text.replace("part[2] : Part(1 ms)", f"part[i < 2] : Part({given})"))
    found = [d.code for d in pipeline.check(source, lambda _: source).report.diagnostics]
    assert ("E0612" in found) is is_refused


@pytest.mark.parametrize(("given", "is_refused"), [(["part[1].d"], False), (["part[0].d", "part[1].d"], True)])
def test_a_setting_of_one_instance_leaves_those_that_wait(given: list[str], is_refused: bool) -> None:
    text = PROGRAM.format(part="(o ! n ; mu wait d)", arguments="1 ms", body="skip")
    source = SourceFile(name="case.csp", text=text)
    built = pipeline.build(source, lambda _: source, settings=dict.fromkeys(given, "0 ms"))
    assert ("E0612" in {d.code for d in built.checked.report.diagnostics}) is is_refused


def test_a_setting_decides_as_the_text_does() -> None:
    text = PROGRAM.format(part="o ! n", arguments="1 ms", body="mu wait longest")
    source = SourceFile(name="case.csp", text=text)
    for value, expected in (("1 ms", set()), ("0 ms", {"E0612"})):
        built = pipeline.build(source, lambda _: source, settings={"longest": value})
        assert {d.code for d in built.checked.report.diagnostics if d.severity == "error"} == expected


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ("mu (after 0 ms -> wait 1 ms [] after 3 ms -> skip)", ["W0615"]),
        ("mu (after 0 ms -> wait 1 ms []> after 3 ms -> skip)", ["W0613"]),
        ("mu (after 0 ms -> wait 1 ms []> e ? w -> skip)", ["W0613"]),
        ("mu (after T - 2 ms -> wait 1 ms []> light ! true -> skip)", ["W0613"]),
        ("mu (after v -> wait 1 ms []> e ? w -> skip)", []),
        ("mu (e ? w -> skip []> after 0 ms -> wait 1 ms)", []),
    ],
)
def test_after_a_zero_time_out_no_guard_is_chosen(body: str, expected: list[str]) -> None:
    assert codes(body=body) == expected


SAMPLED = """
process Main {{
  in  x : double @ 2 ms
  out o : int
  communication {{ var y : double = 0 }}
  composition {{ {} ; o ! 1 }}
}}
"""


@pytest.mark.parametrize(
    ("body", "misses"),
    [
        ("(mu (x ? y ; wait 9 ms)) interrupt after 0 ms -> skip", False),
        ("(mu (x ? y ; wait 9 ms)) interrupt skip -> skip", False),
        ("(mu (x ? y ; wait 9 ms)) interrupt after 1 s -> skip", True),
        ("x ? y ; ((x ? y) interrupt after 0 ms -> wait 9 ms) ; x ? y", True),
    ],
)
def test_a_body_that_is_cancelled_at_once_misses_no_samples(body: str, misses: bool) -> None:
    source = SourceFile(name="case.csp", text=SAMPLED.format(body))
    found = [d.code for d in pipeline.check(source, lambda _: source).report.diagnostics]
    assert any(code.startswith("W07") for code in found) is misses, found


def test_a_ready_guard_may_be_followed_by_a_zero_delay() -> None:
    def found(delay: str) -> list[str]:
        text = f"""
process Main {{
  in  e : int
  out o : int
  communication {{ var w : int = 0 }}
  composition {{ mu (e -> (wait {delay} ; e ? w ; o ! w) [] after 1 ms -> skip) }}
}}
"""
        source = SourceFile(name="case.csp", text=text)
        return [d.code for d in pipeline.check(source, lambda _: source).report.diagnostics]

    assert found("0 ms") == []
    assert found("1 ms") == ["E0610"]


def test_a_negative_constant_is_one_error() -> None:
    text = (
        "process Main {\n  composition { (mu wait 1 ms - 2 ms) || mu (after -1 ms -> skip [] after 1 ms -> skip) }\n}\n"
    )
    source = SourceFile(name="case.csp", text=text)
    assert [d.code for d in pipeline.check(source, lambda _: source).report.diagnostics] == ["E0906", "E0906"]


def test_the_delay_is_shown() -> None:
    source = SourceFile(name="case.csp", text="process Main {\n  composition { mu (skip ; wait 0 ms) }\n}\n")
    (found,) = pipeline.check(source, lambda _: source).report.diagnostics
    assert [label.span.text for label in found.labels] == ["wait 0 ms"]
    assert "make it longer" in str(found.help)
