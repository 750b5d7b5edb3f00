"""Fixes: what is surely meant instead of what is wrong, as edits of the text."""

from __future__ import annotations

import pytest

from cspdiag.base import Diagnostic, Report, SourceFile
from cspdiag.base.manual import manual_page
from cspdiag.fix import fix
from cspdiag.syntax.format.formatter import format_tree
from cspdiag.syntax.parser import parse
from tests.docs.kinds_of_diagnostics import kinds_of_diagnostics
from tests.literate import MAIN, check_files, describe

KINDS = kinds_of_diagnostics()

LAW = (
    "submodel Law {\n  in  angle : double\n  in  n     : int\n  in  is_on : bool\n  out y     : double\n\n  y = %s\n}\n"
)
TURN = "submodel Turn {\n  in  a : double<rad>\n  in  b : double<deg>\n  out y : double<rad>\n\n  y = %s\n}\n"
PLAIN = (
    "process Main {\n  in  given : int\n  out taken : int\n\n  communication {\n    var n : int = 0\n  }\n\n"
    "  composition {\n    given ? n ; %s\n  }\n}\n"
)
PORTS = "submodel Law {\n%s\n\n  y = x\n}\n"

DEVICE = 'driver D device "gamepad" {\n  out buttons : int\n}\n'
FIXES = [
    ("E0101", PLAIN.replace("process", "procss") % "taken ! n", PLAIN % "taken ! n"),
    ("E0101", PLAIN.replace("var", "vra") % "taken ! n", PLAIN % "taken ! n"),
    ("E0101", "process P {\n  composition {\n    skip\n  }\n}\n\nassert P deadlock-free\nassert P livelockfree\n",
     "process P {\n  composition {\n    skip\n  }\n}\n\nassert P deadlock free\nassert P livelock free\n"),
    ("E0102", LAW % "angle · 2", LAW % "angle * 2"),
    ("E0102", LAW % "if is_on∧n ≥ 1 then angle else 0", LAW % "if is_on and n >= 1 then angle else 0"),
    ("E0102", LAW % "angle²", LAW % "angle^2"),
    ("E0102", LAW % "2 * π", LAW % "2 * pi"),
    ("E0102", PLAIN % "wait 5 µs ; taken ! n", PLAIN % "wait 5 us ; taken ! n"),
    ("E0102", "const g = 9.81<m/s²>\n", "const g = 9.81<m/s^2>\n"),
    ("E0108", PLAIN % "n = 2 ; taken ! n", PLAIN % "n := 2 ; taken ! n"),
    ("E0108", PLAIN % "n++ ; --n ; n += 3 ; taken ! n", PLAIN % "n := n + 1 ; n := n - 1 ; n := n + 3 ; taken ! n"),
    ("E0108", LAW % "if n = 1 then angle else 0", LAW % "if n == 1 then angle else 0"),
    ("E0108", LAW % "if !is_on then angle else 0", LAW % "if not is_on then angle else 0"),
    ("E0108", LAW % "1. + .5 + 1_000 + 0x10", LAW % "1.0 + 0.5 + 1000 + 16"),
    ("E0108", PORTS % "  input  x : double\n  output y : double", PORTS % "  in  x : double\n  out y : double"),
    ("E0116", "submodel Law method = tustin method = tustin {\n  in  x : double\n  out y : double\n\n  y = x\n}\n",
     "submodel Law method = tustin {\n  in  x : double\n  out y : double\n\n  y = x\n}\n"),
    ("E0117", PLAIN % "wait 5 msec ; wait 2 hours ; taken ! n", PLAIN % "wait 5 ms ; wait 120 min ; taken ! n"),
    ("E0117", "const top = 5<rad / s>\n", "const top = 5<rad/s>\n"),
    ("E0119", PORTS % "  in  x : double;\n  out y : double;", PORTS % "  in  x : double\n  out y : double"),
    ("E0119", PORTS % "  in  x : double, z : int\n  out y : double",
     PORTS % "  in  x : double\n  in  z : int\n  out y : double"),
    ("E0119", PORTS % "  in  x : double @ 10 ms = 1 // m\n  in  z : double @ 10 ms := 2 * (1 + 1)\n  out y : double",
     PORTS % "  in  x : double = 1 @ 10 ms // m\n  in  z : double = 2 * (1 + 1) @ 10 ms\n  out y : double"),
    ("E0202", LAW.replace("y =", "let y =") % "angle", LAW % "angle"),
    ("E0204", LAW % "anlge", LAW % "angle"),
    ("E0204", LAW % "Angle", LAW % "angle"),
    ("E0204", LAW % "arctan(angle) + fabs(angle)", LAW % "atan(angle) + abs(angle)"),
    ("E0204", PORTS % "  in  x : real\n  out y : double", PORTS % "  in  x : double\n  out y : double"),
    ("E0206", "enum Mode { idle, busy }\n\nconst start = Mode.idel\n",
     "enum Mode { idle, busy }\n\nconst start = Mode.idle\n"),
    ("E0212", "struct Pose {\n  angle: double\n}\n\nconst start = Pose(agnle = 0)\n",
     "struct Pose {\n  angle: double\n}\n\nconst start = Pose(angle = 0)\n"),
    ("E0215", manual_page("E0215").refused, manual_page("E0215").fixed),
    ("E0303", TURN % "b", TURN % "convert(b, rad)"),
    ("E0304", LAW % "n * angle", LAW % "double(n) * angle"),
    ("E0305", TURN % "a + b", TURN % "a + convert(b, rad)"),
    ("E0307", "const half = sin(30<deg>)\n", "const half = sin(convert(30<deg>, rad))\n"),
    ("E0308", LAW % "if n then angle else 0", LAW % "if n != 0 then angle else 0"),
    ("E0308", LAW % "if not n then angle else 0", LAW % "if not (n != 0) then angle else 0"),
    ("E0301", LAW % "if is_on then n else angle", LAW % "if is_on then double(n) else angle"),
    ("E0303", "const turns : double<rad>[2] = [90<deg>, 1<rad>]\n",
     "const turns : double<rad>[2] = [convert(90<deg>, rad), 1<rad>]\n"),
    ("E0312", LAW % "max(n, angle)", LAW % "max(double(n), angle)"),
    ("E0312", "const turns = [1<rad>, 90<deg>, 2<rad>]\n", "const turns = [1<rad>, convert(90<deg>, rad), 2<rad>]\n"),
    ("E0312", "const turns = [90<deg>, 1<rad>]\n", "const turns = [convert(90<deg>, rad), 1<rad>]\n"),
    ("E0217", LAW % "lag(angle, 1<s>, method = Tustin)", LAW % "lag(angle, 1<s>, method = tustin)"),
    ("E0456", PORTS.replace("Law", "Law method = Tustin") % "  in  x : double\n  out y : double",
     PORTS.replace("Law", "Law method = tustin") % "  in  x : double\n  out y : double"),
    ("E0602", PLAIN % "(given ? n [] after 1 ms -> skip) ; taken ! n",
     PLAIN % "(given ? n -> skip [] after 1 ms -> skip) ; taken ! n"),
    ("E0830", DEVICE.replace("gamepad", "gampad"), DEVICE),
    ("E0831", DEVICE.replace("buttons", "butons"), DEVICE),
    ("E0122", f'import "{MAIN}"\n\nconst period = 1 ms\n', "const period = 1 ms\n"),
]  # fmt: skip
"""Codes, programs with a mistake, and the same programs fixed; apart from the mistake they are in the
standard format.
"""


NOT_SURE = [
    LAW % "angles",
    LAW.replace("angle", "arm1") % "arm2",
    LAW.replace("angle", "left_x") % "left_y",
    LAW.replace("angle", "Ts") % "ts",
    LAW % "pow(angle, 2)",
    LAW % "saturate(angle, 1)",
    LAW % "is_on ? angle : 0",
    LAW % "größe",
    "const speed : double<m/s> = 5\n",
    "const speed = 5 V\n",
    PLAIN % "taken ! n }",
    PLAIN % "wait 5 µ ; taken ! n",
    PLAIN % "n += (n + 1) ; taken ! n",
    'driver D python "d.py:D {\n  out y : double\n}\n',
]
"""Programs without a fix, because several are possible, or the only one is not certain."""


def fixed(text: str) -> tuple[str, list[Diagnostic]]:
    """A program after its fixes, and the remaining diagnostics."""

    def read(path: str) -> SourceFile:
        raise FileNotFoundError(2, "no such file", path)

    source = SourceFile(name=MAIN, text=text)
    result = fix([source], read, str)
    return (result.files[0].text if result.files else text), list(result.left)


@pytest.mark.parametrize(("code", "before", "after"), FIXES, ids=[code for code, _, _ in FIXES])
def test_a_fixed_program_is_clean_and_in_the_standard_format(code: str, before: str, after: str) -> None:
    assert code in {found.code for found in check_files({MAIN: before}).report.diagnostics}
    text, left = fixed(before)
    assert left == [], describe(left)
    assert text == after
    assert format_tree(parse(SourceFile(name=MAIN, text=text), Report())) == text


OF_TYPES = [(code, before) for code, before, _ in FIXES if code.startswith("E03")]


@pytest.mark.parametrize(("code", "before"), OF_TYPES, ids=[code for code, _ in OF_TYPES])
def test_what_is_written_in_the_help_of_a_type_error_is_its_fix(code: str, before: str) -> None:
    found = [each for each in check_files({MAIN: before}).report.diagnostics if each.code == code and each.edits]
    assert found
    for each in found:
        (edit,) = each.edits
        assert edit.replacement in (each.help or "")


def test_every_kind_with_a_fix_is_shown() -> None:
    with_fixes = {kind.code for kind in KINDS if kind.edits is not Diagnostic.edits}
    assert with_fixes == {code for code, _, _ in FIXES}


@pytest.mark.parametrize("text", NOT_SURE, ids=range(len(NOT_SURE)))
def test_uncertain_corrections_are_not_applied(text: str) -> None:
    assert check_files({MAIN: text}).report.diagnostics
    unchanged, left = fixed(text)
    assert (unchanged, [found.edits for found in left]) == (text, [()] * len(left))


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.code)
def test_the_refused_program_of_a_page_is_fixed_whole_if_at_all(kind: type[Diagnostic]) -> None:
    page = manual_page(kind.code)
    found = check_files({MAIN: page.refused}).report.diagnostics
    if any(each.edits for each in found):
        _, left = fixed(page.refused)
        assert left == [], describe(left)


def test_a_fix_that_uncovers_more_errors_is_undone() -> None:
    law = "submodel Screen {\n  in  x : double\n  out y : double\n\n  y = x\n}\n\n"
    main = (
        "process Main {\n  communication {\n    pick : screen(base = 1)\n    pick.a -> pick.b\n  }\n\n"
        "  composition {\n    pick\n  }\n}\n"
    )
    text, left = fixed(law + main)
    assert text == law + main
    assert [found.code for found in left] == ["E0204"]


def test_fixes_that_touch_are_applied_one_after_the_other() -> None:
    assert fixed(LAW % "n * n * angle") == (LAW % "double(n * n) * angle", [])
    assert fixed(LAW % "anlge² + anlge") == (LAW % "angle^2 + angle", [])
