from __future__ import annotations

import re
from textwrap import dedent

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.base.render.text import render
from tests.base.render.samples import Sample, SampleWarning, at, source

ARM = source("process Arm {\n  in  angle : double<rad>\n  out drive : double<V>\n  angle -> drive\n}\n")


def shown(*diagnostics: Diagnostic) -> str:
    return render(diagnostics)


def test_nothing_is_shown_as_nothing() -> None:
    assert render([]) == ""


def test_both_places_are_in_one_snippet() -> None:
    labels = (Label(at(ARM, "drive : double<V>"), "takes `double<V>`"),)
    diagnostic = Sample(at(ARM, "angle -> drive"), "units differ", "gives `double<rad>`", "use `convert`", labels)
    assert shown(diagnostic) == dedent("""\
        error[E0316]: units differ
         --> arm.csp:4:3
          |
        3 |   out drive : double<V>
          |       ----------------- takes `double<V>`
        4 |   angle -> drive
          |   ^^^^^^^^^^^^^^ gives `double<rad>`
          |
          = help: use `convert`

        1 error
        """)


def test_distant_places_are_joined_by_dots() -> None:
    labels = (Label(at(ARM, "process"), ""),)
    assert shown(Sample(at(ARM, "angle -> drive"), "far", "here", None, labels)) == dedent("""\
        error[E0316]: far
         --> arm.csp:4:3
          |
        1 | process Arm {
          | -------
        ...
        4 |   angle -> drive
          |   ^^^^^^^^^^^^^^ here

        1 error
        """)


def test_a_place_in_another_file_has_its_own_snippet() -> None:
    laws = source("submodel Law {\n}\n", "laws.csp")
    labels = (Label(at(laws, "Law"), "defined here"),)
    assert shown(Sample(at(ARM, "Arm"), "same name", "", None, labels)) == dedent("""\
        error[E0316]: same name
         --> arm.csp:1:9
          |
        1 | process Arm {
          |         ^^^
          |
         ::: laws.csp:1:10
          |
        1 | submodel Law {
          |          --- defined here

        1 error
        """)


def test_several_marks_in_a_line_hang_their_words_on_bars() -> None:
    file = source("alpha -> beta -> gamma\n")
    labels = (Label(at(file, "alpha"), "from"), Label(at(file, "gamma"), "to"))
    assert shown(Sample(at(file, "beta"), "no", "by way of", None, labels)) == dedent("""\
        error[E0316]: no
         --> arm.csp:1:10
          |
        1 | alpha -> beta -> gamma
          | -----    ^^^^    ----- to
          | |        |
          | |        by way of
          | |
          | from

        1 error
        """)


def test_a_range_of_lines_has_a_bracket() -> None:
    assert shown(Sample(at(ARM, ARM.text[12:-1]), "whole block", "all this")) == dedent("""\
        error[E0316]: whole block
         --> arm.csp:1:13
          |
        1 | / process Arm {
        2 | |   in  angle : double<rad>
        3 | |   out drive : double<V>
        4 | |   angle -> drive
        5 | | }
          | |_^ all this

        1 error
        """)


def test_a_long_range_is_cut_in_the_middle() -> None:
    file = source("(\n" + "  skip ;\n" * 50 + "  stop\n)\n")
    text = shown(Sample(at(file, file.text.rstrip()), "long"))
    assert text.splitlines()[3:] == [
        " 1 | / (",
        " 2 | |   skip ;",
        " 3 | |   skip ;",
        "...  |",
        "51 | |   skip ;",
        "52 | |   stop",
        "53 | | )",
        "   | |_^",
        "",
        "1 error",
    ]


def test_tabs_and_wide_characters_keep_the_marks_below_their_text() -> None:
    file = source("\tx // 速度 y\n")
    assert shown(Sample(at(file, "x"), "a")).splitlines()[3:5] == ["1 |     x // 速度 y", "  |     ^"]
    assert shown(Sample(at(file, "y"), "a")).splitlines()[3:5] == ["1 |     x // 速度 y", "  |               ^"]
    assert shown(Sample(at(file, "速"), "a")).splitlines()[4] == "  |          ^^"


def test_control_characters_cannot_steer_the_terminal() -> None:
    file = source("x \x1b[31m y\n", "\x1b]0;title\x07.csp")
    text = shown(Sample(at(file, "y"), "found \x1b[31m", "\x07", "\x08"))
    assert not any(ord(character) < 0x20 and character != "\n" for character in text)
    assert "1 | x ␛[31m y" in text


def test_a_place_after_the_last_character_is_marked() -> None:
    file = source("x")
    assert shown(Sample(Span(file, 1, 1), "more wanted")).splitlines()[3:5] == ["1 | x", "  |  ^"]
    empty = source("")
    assert shown(Sample(Span(empty, 0, 0), "empty")).splitlines()[4] == "  | ^"


def test_a_long_line_shows_the_part_around_the_mark() -> None:
    file = source("a" * 5000 + " middle " + "b" * 5000 + "\n")
    line, mark = shown(Sample(at(file, "middle"), "long line")).splitlines()[3:5]
    assert len(line) < 180
    assert line.startswith("1 | ...aaa")
    assert line.endswith("bbb...")
    assert line[mark.index("^") : mark.rindex("^") + 1] == "middle"


def test_a_mark_longer_than_the_window_is_cut() -> None:
    file = source("a" * 5000 + "\n")
    line, mark = shown(Sample(at(file, "a" * 5000), "long mark")).splitlines()[3:5]
    assert len(mark) <= len(line) < 180


def test_the_summary_counts() -> None:
    error, warning = Sample(at(ARM, "angle"), "e"), SampleWarning(at(ARM, "drive"), "w")
    assert shown(error, error, warning).endswith("\n2 errors, 1 warning\n")
    assert shown(warning).startswith("warning[W0512]: w\n")


def test_colour_changes_nothing_but_colour() -> None:
    labels = (Label(at(ARM, "process"), "here"),)
    diagnostics = [Sample(at(ARM, ARM.text[12:-1]), "block", "all", "fix\nso", labels)]
    coloured = render(diagnostics, colour=True)
    assert "\x1b[1;31m" in coloured
    assert re.sub(r"\x1b\[[0-9;]*m", "", coloured) == render(diagnostics)


def test_a_help_of_several_lines_is_aligned() -> None:
    text = shown(Sample(at(ARM, "angle"), "e", "", "write\n(a ; b) || c"))
    assert "  = help: write\n          (a ; b) || c\n" in text
