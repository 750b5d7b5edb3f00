"""Words that are keywords in some places: they are names in all others, whatever the name is of."""

from __future__ import annotations

import pytest

from cspdiag import pipeline
from cspdiag.base import SourceFile
from cspdiag.base.sources import read_source
from cspdiag.syntax.parse.lexer import CONTEXTUAL_KEYWORDS

DECLARED = {
    "constant": "const WORD = 3\nprocess P { out y : int communication { } composition { y ! WORD + 1 ; y ! (WORD) } }",
    "type": "type WORD = int\nprocess P { out y : WORD communication { var v : WORD = 1 } composition { y ! v } }",
    "enum": "enum WORD { a, b }\nprocess P { out y : WORD communication { } composition { y ! WORD.a } }",
    "literal": "enum E { WORD, b }\nprocess P { out y : E communication { } composition { y ! E.WORD } }",
    "struct": "struct WORD { a : int }\nprocess P { out y : WORD communication { } composition { y ! WORD(a = 1) } }",
    "field": (
        "struct S { WORD : int  other : int }\nprocess P { out y : int"
        " communication { var v : S = S(WORD = 1, other = 2) }"
        " composition { y ! v.WORD } }"
    ),
    "exception": "exception WORD\nprocess P { composition { raise WORD catch WORD -> skip } }",
    "parameter": "parameter WORD = 3\nprocess P { out y : int communication { } composition { y ! WORD } }",
    "parameter of a process": (
        "process Q(WORD: int) { out y : int communication { } composition { y ! WORD } }\n"
        "process P { out y : int communication { q : Q(WORD = 2)  q.y -> y } composition { q } }"
    ),
    "process": "process WORD { composition { skip } }\nprocess P { communication { q : WORD } composition { q } }",
    "control law": (
        "submodel WORD { in u : double out y : double y = u }\n"
        "process P { in u : double @ 1 ms out y : double @ 1 ms"
        " communication { law : WORD u -> law.u law.y -> y } composition { mu law } }"
    ),
    "variable": (
        "process P { in u : int out y : int communication { var WORD : int = 0 }"
        " composition { u ? WORD ; WORD := WORD + 1 ; y ! WORD } }"
    ),
    "array": (
        "process P { in u : int out y : int communication { var WORD : int[2] = [0, 0] }"
        " composition { u ? WORD[0] ; WORD[1] := WORD[0] ; y ! WORD[1] } }"
    ),
    "struct in a variable": (
        "struct S { a : int }\nprocess P { out y : int"
        " communication { var WORD : S = S(a = 1) } composition { y ! WORD.a } }"
    ),
    "label": "process P { composition { WORD : skip ; (WORD: stop) } }",
    "index": (
        "process P { in u[2] : int out y[2] : int communication { var x : int = 0 }"
        " composition { seq WORD < 2 : (u[WORD] ? x ; y[WORD] ! x) } }"
    ),
    "index of relationships": (
        "process Q { in u[2] : int communication { var x : int = 0 } composition { seq i < 2 : (u[i] ? x) } }\n"
        "process P { in u[2] : int communication { q : Q for WORD < 2 { u[WORD] -> q.u[WORD] } } composition { q } }"
    ),
    "state, let and output of a law": (
        "submodel L { in u : double out y : double state WORD : double = 0 let other = WORD + u"
        " next WORD = other y = WORD }\n"
        "process P { in u : double @ 1 ms out y : double @ 1 ms"
        " communication { law : L u -> law.u law.y -> y } composition { mu law } }"
    ),
    "derivative and let of a law": (
        "submodel L { in u : double out y : double state x : double = 0 let WORD = u der x = WORD y = WORD * x }\n"
        "process P { in u : double @ 1 ms out y : double @ 1 ms"
        " communication { law : L u -> law.u law.y -> y } composition { mu law } }"
    ),
    "ports of a law": (
        "submodel L { in u : double out WORD : double WORD = u }\n"
        "process P { in u : double @ 1 ms out y : double @ 1 ms"
        " communication { law : L u -> law.u law.WORD -> y } composition { mu law } }"
    ),
    "array of outputs of a law": (
        "submodel L { in u : double out WORD[2] : double WORD[0] = u WORD[1] = 2 * u }\n"
        "process P { in u : double @ 1 ms out y[2] : double @ 1 ms"
        " communication { law : L u -> law.u law.WORD -> y } composition { mu law } }"
    ),
    "law": (
        "submodel L { in u : double out y : double y = u }\n"
        "process P { in u : double @ 1 ms out y : double @ 1 ms"
        " communication { WORD[2] : L  u -> WORD[0].u WORD[0].y -> WORD[1].u WORD[1].y -> y }"
        " composition { mu (seq i < 2 : WORD[i]) } }"
    ),
    "asserted": "process WORD { composition { skip } }\nassert WORD deadlock free\nassert WORD terminates",
    "hidden": (
        "process Q { out WORD : int communication { } composition { skip } }\n"
        "process P { out WORD : int communication { } composition { WORD ! 1 } }\nassert P refines Q hide WORD"
    ),
}  # fmt: skip
"""Programs in which WORD is the name of something."""

INPUTS = {
    "read": "WORD ? x",
    "read in a sequence": "WORD ? x ; (WORD ? x) ; skip",
    "guard": "(WORD ? x -> skip) [] (after 1 ms -> skip)",
    "guard after another": "(after 1 ms -> skip) []> (WORD ? x -> skip)",
    "guard with a condition": "(when x > 0 & WORD ? x -> skip) [] (after 1 ms -> skip)",
    "ready": "(WORD -> WORD ? x) [] (after 1 ms -> skip)",
    "interrupt": "(stop interrupt WORD ? x -> skip)",
    "interrupt when ready": "(stop interrupt WORD -> WORD ? x)",
    "catch": "(WORD ? x catch Fault -> WORD ? x)",
    "if": "if x > 0 then WORD ? x else WORD ? x",
    "while": "while x > 0 do WORD ? x",
    "mu": "mu WORD ? x until x > 3",
    "label": "here : WORD ? x",
    "parallel": "skip || (WORD ? x)",
    "comment": "WORD /* the port */ // and\n ? x",
}
OUTPUTS = {"write": "WORD ! 1", "guard": "(WORD ! 1 -> skip) [] (after 1 ms -> skip)"}

CHANNEL = {
    "channel": "channel WORD : int",
    "buffer": "channel WORD : int buffer 2",
}


STOP = """process Q { composition { skip } }
process P { communication { stop : Q  r : Q } composition { stop || r } }"""


def problems(text: str) -> list[str]:
    """What is wrong in a program."""
    report = pipeline.check(SourceFile(name="main.csp", text=text), read_source).report
    return [f"{found.code} {found.message}" for found in report.diagnostics if found.severity == "error"]


@pytest.mark.parametrize("word", sorted(CONTEXTUAL_KEYWORDS))
@pytest.mark.parametrize("kind", DECLARED)
def test_anything_may_have_such_a_name(kind: str, word: str) -> None:
    assert problems(DECLARED[kind].replace("WORD", word)) == []


@pytest.mark.parametrize("word", sorted(CONTEXTUAL_KEYWORDS))
@pytest.mark.parametrize("form", INPUTS)
def test_a_port_is_used_by_such_a_name(form: str, word: str) -> None:
    for declared, used in (("WORD", "WORD"), ("WORD[2]", "WORD[1]"), ("WORD[2]", "WORD [ 0 ]")):
        text = f"process P {{ in {declared} : int communication {{ var x : int = 0 }} composition {{ BODY }} }}"
        body = INPUTS[form].replace("WORD", used)
        assert problems(text.replace("BODY", body).replace("WORD", word)) == [], used


@pytest.mark.parametrize("word", sorted(CONTEXTUAL_KEYWORDS))
@pytest.mark.parametrize("form", OUTPUTS)
def test_an_output_is_used_by_such_a_name(form: str, word: str) -> None:
    for declared, used in (("WORD", "WORD"), ("WORD[2]", "WORD[1]")):
        text = f"process P {{ out {declared} : int communication {{ }} composition {{ BODY }} }}"
        assert problems(text.replace("BODY", OUTPUTS[form].replace("WORD", used)).replace("WORD", word)) == [], used


@pytest.mark.parametrize("word", sorted(CONTEXTUAL_KEYWORDS))
@pytest.mark.parametrize("kind", CHANNEL)
def test_a_channel_is_used_by_such_a_name(kind: str, word: str) -> None:
    text = f"process P {{ communication {{ {CHANNEL[kind]} var x : int = 0 }} composition {{ WORD ! 1 || WORD ? x }} }}"
    assert problems(text.replace("WORD", word)) == []


def test_an_instance_by_the_name_of_a_process_of_the_language_is_refused_with_what_to_do() -> None:
    (found,) = pipeline.check(SourceFile(name="main.csp", text=STOP), read_source).report.diagnostics
    assert found.code == "E0607"
    assert found.help == "`stop` by itself is the process that never ends: give the instance another name"
    assert problems(STOP.replace("stop : Q", "stop[2] : Q").replace("stop ||", "stop[0] || stop[1] ||")) == []
