"""What is reported never to happen at a place in the text never happens in any iteration of a replicator or in any
instance.
"""

from __future__ import annotations

import pytest

from cspdiag import pipeline
from cspdiag.base import SourceFile

PROCESS = """
exception X
process Main {{
  in  x : int @ 1 ms
  out o : int
  communication {{ x -> _ }}
  composition {{ {composition} }}
}}
"""
INSTANCES = """
process Part(d: time = 1 ms, n: int = 1) {{
  in  c : {kind}
  out o : int
  communication {{ var v : {kind} = {initial} }}
  composition {{ {part} }}
}}
process Main {{
  in  c : {kind}
  out o : int
  communication {{
    a : Part({first})
    b : Part({second})
    c -> broadcast -> a.c, b.c
    a.o, b.o -> any -> o
  }}
  composition {{ a || b }}
}}
"""


def codes(text: str) -> list[str]:
    """The codes of the diagnostics of a program."""
    source = SourceFile(name="case.csp", text=text)
    return [found.code for found in pipeline.check(source, lambda _: source).report.diagnostics]


@pytest.mark.parametrize(
    ("composition", "expected"),
    [
        ("seq k < 3 : (when k != 1 & skip -> o ! k []> after 1 ms -> o ! 10 + k)", []),
        ("seq k < 3 : (when k == 7 & after 1 ms -> o ! k []> skip -> o ! 0 []> after 1 ms -> o ! 10)", ["W0613"]),
        ("(seq k < 4 : (o ! k ; (if k == 2 then raise X))) catch X -> skip", []),
        ("(seq k < 4 : ((if k == 2 then raise X) ; o ! k)) catch X -> skip", []),
        ("(seq k < 4 : (raise X ; o ! k)) catch X -> skip", ["W0611"]),
        ("seq k < 3 : (after k * 1 ms -> o ! k [] after 1 ms -> o ! 50 + k)", []),
        ("seq k < 3 : (after (k + 2) * 1 ms -> o ! k [] after 1 ms -> o ! 50 + k)", ["W0615"]),
        ("seq k < 3 : (when false & after 1 ms -> o ! k [] skip -> o ! 0)", ["W0613", "W0615"]),
        ("prialt k < 3 : after (3 - k) * 1 ms -> o ! k", []),
        ("prialt k < 2 : when k == 1 & after 1 ms -> o ! k", []),
        ("prialt k < 2 : after 1 ms -> o ! k", []),
    ],
)
def test_all_iterations_agree(composition: str, expected: list[str]) -> None:
    assert codes(PROCESS.format(composition=composition)) == expected


@pytest.mark.parametrize(
    ("part", "first", "second", "expected"),
    [
        ("mu (o ! n ; (c ? v -> skip []> after d -> skip))", "0 ms", "1 ms", []),
        ("mu (after d -> o ! n []> after 2 ms -> c ? v)", "1 ms", "3 ms", []),
        ("mu (after 1 ms -> o ! n []> after 2 ms -> c ? v)", "d = 1 ms", "d = 2 ms", ["W0615"]),
        ("c ? v ; o ! 1 ; (seq i < n : stop) ; wait d", "n = 0", "n = 1", []),
        ("c ? v ; o ! 1 ; (seq i < n : stop) ; wait d", "n = 1", "n = 2", ["W0611"]),
        ("seq i < n : (c ? v ; o ! 1)", "n = 0", "n = 1", []),
        ("(mu (c ? v ; o ! v) until v > 9) ; (mu wait d)", "0 ms", "1 ms", []),
        ("(mu (c ? v ; o ! v) until v > 9) ; (mu wait d)", "0 ms", "0 ms", ["E0612"]),
        ("c ? v ; wait d ; mu (o ! 1) until n > 3", "n = 5", "n = 7", []),
        ("c ? v ; wait d ; mu (o ! 1) until n > 3", "n = 5", "n = 1", []),
        ("c ? v ; wait d ; mu (o ! 1) until n > 3", "n = 2", "n = 1", ["E0612"]),
        ("c ? v ; wait d ; mu (o ! 1) until n > 3", "n = 1", "n = 1", ["E0612"]),
        ("c ? v ; wait d ; mu (o ! 1) until n > 3 or v > 4", "n = 1", "n = 1", ["E0612"]),
        ("c ? v ; o ! 1 ; while d > 3 ms do o ! 1", "2 ms", "3 ms", []),
        ("c ? v ; o ! 1 ; while d > 3 ms do o ! 1", "4 ms", "4 ms", ["E0612"]),
        ("c ? v ; wait d ; seq k < 3 : mu (o ! n) until k < 3", "n = 1", "n = 2", []),
        ("c ? v ; wait d ; seq k < 3 : mu (o ! n) until k < 2", "n = 1", "n = 2", ["E0612"]),
    ],
)
def test_all_instances_agree(part: str, first: str, second: str, expected: list[str]) -> None:
    found = codes(INSTANCES.format(part=part, first=first, second=second, kind="int", initial=0))
    assert found == expected


@pytest.mark.parametrize(("second", "expected"), [("n = 0", ["W0616"]), ("n = 1", [])])
def test_a_button_is_checked_if_any_instance_reads_it(second: str, expected: list[str]) -> None:
    part = "mu ((mu wait d) interrupt c ? v -> (o ! 1 ; seq i < n : if v then o ! 2))"
    found = codes(INSTANCES.format(part=part, first="n = 0", second=second, kind="bool", initial="false"))
    assert found == expected
