"""What completion offers besides names and keywords (``tests/lsp/cases``): units, functions and files."""

from __future__ import annotations

from pathlib import Path

import pytest

from cspdiag.base.sources import read_source
from cspdiag.base.span import SourceFile
from cspdiag.editing.completion import completion
from cspdiag.editing.view import View
from cspdiag.syntax.parser import parse

CURSOR = "§"
PROGRAM = """\
const LIMIT = 3
submodel Law(gain: double<V/rad> = 1<V/rad>) {{ in x : double  out y : double  y = {equation} }}
process Main {{
  in  x : double
  communication {{ law : Law{arguments}  var v : double }}
  composition {{ mu (x ? v ; {step}) }}
}}
"""


def offered(text: str, name: str = "main.csp") -> list[str]:
    """The labels at the cursor."""
    main = SourceFile(name=name, text=text.replace(CURSOR, ""))
    return [each.label for each in completion(View(main, read_source, parse), text.index(CURSOR))]


def in_program(*, equation: str = "x", arguments: str = "", step: str = "law") -> list[str]:
    return offered(PROGRAM.format(equation=equation, arguments=arguments, step=step))


@pytest.mark.parametrize(
    "text",
    ["const q = 10<§\n", "const q = 10<V> + 3<§V>\n", "const q = 1.5e3<V/§\n", "process P { in x : double<m*§ }"],
)
def test_only_units_are_offered_where_one_is_written(text: str) -> None:
    found = offered(text)
    assert {"V", "rad"} <= set(found)
    assert not {"abs", "pi", "double"} & set(found)


def test_and_in_an_argument() -> None:
    assert "rad" in in_program(arguments="(gain = 2<§")


@pytest.mark.parametrize("text", ["const q = LIMIT < §\n", "const q = LIMIT / §\n", "const q = 3 < §\n"])
def test_a_comparison_and_a_quotient_are_no_units(text: str) -> None:
    assert "pi" in offered(text)


def test_units_of_durations_are_offered_after_a_number() -> None:
    units = ["ns", "us", "ms", "s", "min", "Hz", "kHz", "MHz"]
    assert in_program(step="wait 5 §")[: len(units)] == units
    assert offered("process P { in x : int @ 10 §")[: len(units)] == units
    assert "ms" not in offered("const q = LIMIT §")


def test_functions_with_memory_are_offered_in_equations_only() -> None:
    memory = {"pre", "delay", "integral", "derivative", "lag", "transfer", "statespace"}
    assert memory <= set(in_program(equation="§"))
    for found in (in_program(step="v := §"), in_program(step="if §"), offered("const q = §")):
        assert "abs" in found
        assert not memory & set(found)


def test_the_present_instant_is_offered_in_compositions_only() -> None:
    assert "now" in in_program(step="wait until §")
    assert "now" not in in_program(equation="§")
    assert "now" not in offered("const q = §")


def test_programs_beside_this_one_are_offered_to_be_imported(tmp_path: Path) -> None:
    for name in ("laws.csp", "main.csp", "notes.txt"):
        (tmp_path / name).write_text("", encoding="utf-8")
    assert offered('import "§"\n', str(tmp_path / "main.csp")) == ["laws.csp"]
    assert offered('import "la§', str(tmp_path / "main.csp")) == ["laws.csp"]
    assert offered('import "§"\n', str(tmp_path / "gone" / "main.csp")) == []
    assert offered('import "§"\n') == []
    assert offered('const q = "§"\n', str(tmp_path / "main.csp")) == []
