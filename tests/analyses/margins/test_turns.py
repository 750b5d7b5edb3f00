"""What a period of a loop does with its values besides running laws: it is followed or refused, never ignored.

Every verdict is compared with runs of the program; a law without margins is named with the reason and its place.
"""

from __future__ import annotations

import pytest

import cspdiag
from tests.analyses.margins.random_turns import contradiction, search
from tests.models.programs import MODELS
from tests.support.thorough import usual_or_thorough

LOOP = """
submodel Law {{ in a : double  in b : double  out u : double  u = -({ka}) * a - ({kb}) * b }}
process Top {{
  in  y : double @ 10 ms
  in  z : double @ 10 ms
  out u : double @ 10 ms
  communication {{
    law : Law
    var v : double = 0
    var b : double = 0
    {connections}
    law.u -> u
  }}
  composition {{ {composition} }}
}}
submodel Plant {{
  in u : double  out y : double  out z : double
  state x : double = 0.1
  der x = 25 * u / 1<s>
  y = x  z = x
}}
environment B for Top {{ p : Plant  u -> p.u  p.y -> y  p.z -> z }}
"""

BOTH = "y -> law.a  b -> law.b"


def program(composition: str, connections: str = BOTH, ka: float = 1, kb: float = 9) -> str:
    return LOOP.format(composition=composition, connections=connections, ka=ka, kb=kb)


FOLLOWED = [
    (program("mu (z ? v ; b := v ; law)"), False),
    (program("mu (z ? b ; law)"), False),
    (program("mu (z ? v ; b := v ; law)", kb=1), True),
    (program("mu (y ? v ; law)", "v -> law.a  b -> law.b", ka=3), True),
    (program("mu (y ? v ; law)", "v -> law.a  b -> law.b", ka=5), False),
    (program("mu (law ; b := 0.5)", ka=3), True),
    (program("mu (b := 2 * v - 0.5 * b ; z ? v ; law)", kb=0.1), True),
    (program("mu (law ; z ? v ; b := v ; u ! 2 * v - 3 * b)", "y -> law.a  b -> law.b"), None),
]


@pytest.mark.parametrize(("text", "is_stable"), FOLLOWED)
def test_values_are_followed_through_the_composition(text: str, is_stable: bool | None) -> None:
    report = cspdiag.parse(text).margins()
    if is_stable is None:
        assert report.loops == ()
        assert report.refusals
        return
    (loop,) = report.loops
    assert loop.margins.is_stable == is_stable
    assert report.refusals == ()
    assert contradiction(text) == (True, None)


REFUSED = [
    (program("mu (law ; y ? v ; y ? v)", ka=3), "it takes two samples of `y` in one iteration"),
    (program("mu (law ; u ! 2 * v)", ka=3), "does not come back to it"),
    (program("mu (law ; u ! 0)", ka=5), "does not come back to it"),
    (program("mu (z ? v ; if v > 0 then b := 1 else b := -1 ; law)"), "it is under a condition"),
    (program("mu (z ? v ; b := v * v ; law)"), "compute it in a submodel"),
    (program("mu (z ? v ; b := v / (2 - 2) ; law)"), "divided by zero"),
    (program("mu (z ? v ; while b > 1 do b := 0.5 * b ; b := v ; law)"), "nothing shows that it ends"),
    (program("mu (law ; law)", ka=3), "is run in several places"),
    (program("mu (wait 3 ms ; law)", ka=3), "the loop waits for a time"),
    (program("mu (law ; reset law)", ka=3), "the loop resets an instance"),
    (program("mu (law catch Timeout -> u ! 0)", ka=3), "it is in a `catch` within the loop"),
    (program("mu (mu law until v > 1 ; u ! 0)", ka=3), "it is in a loop inside another loop"),
    (program("(mu law) interrupt z ? v -> u ! 0", ka=3), "the next sample interrupts it"),
    (program("mu law until true", ka=3), "its loop ends after one iteration"),
    (program("law", ka=3), "it is not in a loop"),
]


@pytest.mark.parametrize(("text", "reason"), REFUSED)
def test_what_is_not_followed_is_refused_with_its_place(text: str, reason: str) -> None:
    report = cspdiag.parse(text).margins()
    assert report.loops == ()
    (refusal,) = report.refusals
    assert reason in refusal.reason
    assert refusal.span is not None


@pytest.mark.parametrize("composition", ["b := 10 ; mu law", "mu (law ; b := 10)", "mu (z ? b ; law)"])
def test_a_gain_that_the_composition_changes_is_not_taken_at_its_initial_value(composition: str) -> None:
    text = program(composition).replace("u = -(1) * a - (9) * b", "u = -a * (1 + b)").replace("z = x", "z = 10")
    report = cspdiag.parse(text).margins()
    assert report.loops == ()
    (refusal,) = report.refusals
    assert "`b` gets another value here than its initial one" in refusal.reason


CASCADE = (MODELS / "cascade" / "cascade.csp").read_text(encoding="utf-8").replace("kp = 0.2<", "kp = 6<")
INNER = "mu (reference ? target -> skip []> current -> law)"


def cascade(inner: str) -> str:
    """The cascade with a different composition of the current loop."""
    assert INNER in CASCADE
    return CASCADE.replace(INNER, inner).replace("var target", "var t2 : double<A> = 0<A>\n    var target")


@pytest.mark.parametrize(
    "inner",
    [
        "mu (reference ? t2 -> target := t2 []> current -> law)",
        "mu (current -> law []> reference ? target -> skip)",
        "mu (reference ? t2 -> target := 30 * t2 []> current -> law)",
    ],
)
def test_an_outer_loop_does_not_vanish(inner: str) -> None:
    direct = cspdiag.parse(CASCADE).margins().loops[0].margins
    report = cspdiag.parse(cascade(inner)).margins()
    found = {loop.opened.cut.name: loop.margins for loop in report.loops}
    assert report.refusals == ()
    assert set(found) == {"outer.law.control", "inner.law.control"}
    assert not found["outer.law.control"].is_stable
    if "30" not in inner:
        assert found["outer.law.control"].gain == pytest.approx(direct.gain, rel=0.05)


@pytest.mark.parametrize(
    ("inner", "reason"),
    [
        ("mu (reference ? target -> skip [] current -> law)", "write `[]>`"),
        ("mu (reference ? t2 -> (if t2 > 1<A> then target := t2) []> current -> law)", "it is under a condition"),
        ("mu (reference ? t2 -> target := 0.1<1/A> * t2 * t2 []> current -> law)", "compute it in a submodel"),
        ("mu (when t2 < 1<A> & reference ? target -> skip []> current -> law)", "it waits at `wanted` without bound"),
    ],
)
def test_an_outer_loop_that_is_not_followed_is_refused(inner: str, reason: str) -> None:
    report = cspdiag.parse(cascade(inner)).margins()
    assert reason in {refusal.law: refusal.reason for refusal in report.refusals}["Cascade.outer.law"]


def test_no_verdict_on_a_random_program_contradicts_its_runs() -> None:
    verdicts, wrong = search(usual_or_thorough(60, 600), seed=7)
    assert wrong == []
    assert verdicts > usual_or_thorough(10, 100)
