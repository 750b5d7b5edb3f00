"""A program of many elements is found to be clean by way of fewer of them only where every element is."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from cspdiag import pipeline
from cspdiag.base.diagnostic import Diagnostic
from cspdiag.base.sources import read_source
from cspdiag.base.span import SourceFile
from tests.support.counting import lines
from tests.support.unrolled import forms

NETWORKS = Path(__file__).parents[3] / "benchmarks" / "networks"
SIZE = 230
"""More than are always checked one by one."""


def found_in(text: str) -> pipeline.Checked:
    return pipeline.check(SourceFile(name="main.csp", text=text), read_source, for_findings=True)


def is_decided_by_fewer(text: str) -> bool:
    """Whether fewer elements have been enough; what is found is compared with a check of all."""
    source = SourceFile(name="main.csp", text=text)
    found, full = (pipeline.check(source, read_source, for_findings=only) for only in (True, False))
    assert shown(found.report.diagnostics) == shown(full.report.diagnostics)
    return found.analysis is None


def shown(diagnostics: list[Diagnostic]) -> list[tuple[object, ...]]:
    return [(one.code, one.message, one.help, one.span, one.labels) for one in diagnostics]


def network(name: str, size: int) -> str:
    return re.sub(r"const size = \d+", f"const size = {size}", (NETWORKS / f"{name}.csp").read_text(encoding="utf-8"))


def test_programs_with_mistakes_anywhere_are_found_to_be_clean_only_if_they_are() -> None:
    assert sum(is_decided_by_fewer(forms(seed)[0](SIZE)) for seed in range(40)) > 8


@pytest.mark.parametrize("name", ["ring", "pipeline", "workers", "star", "alternative"])
def test_fewer_elements_of_a_large_network_are_enough(name: str) -> None:
    assert is_decided_by_fewer(network(name, SIZE))
    assert not is_decided_by_fewer(network(name, 30))


def test_a_hundred_times_as_many_elements_take_hardly_more_steps() -> None:
    def steps(size: int) -> int:
        return lines(lambda: found_in(network("ring", size)))

    found_in(network("ring", SIZE))
    assert steps(100 * SIZE) < 2 * steps(SIZE)


CHAIN = """
const size = 230

process Cell(gain: int = 0) {
  in  input  : int
  out output : int

  communication {
    var value : int = 0
  }

  composition {
    mu (input ? value ; output ! value)
  }
}

process Ring {
  communication {
    cell[size] : Cell

    for i < size {
      cell[i].output -> cell[(i + 1) % size].input
    }
  }

  composition {
    par i < size : cell[i]
  }
}
"""


@pytest.mark.parametrize(
    ("written", "instead"),
    [
        ("cell[size] : Cell", "cell[i < size] : Cell(gain = i * 46116860184273879)"),  # one overflows
        ("cell[size] : Cell", "cell[i < size] : Cell(gain = 1 / (i - 200))"),
        ("cell[size] : Cell", "cell[i < size] : Cell(gain = if i == 200 then 1 / 0 else 1)"),
        ("(i + 1) % size", "(i + 1 + i / 229) % size"),  # one is connected twice
        ("(i + 1) % size", "(i + 1 + 229 / (i + 1) / 229) % size"),
        ("(i + 1) % size", "i + 1"),  # one is out of range
        ("(i + 1) % size", "(i + 1) % (size - 1)"),
        ("i < size {", "i < size - 1 {"),  # one is not connected
        ("i < size {", "i < 229 {"),
        ("par i < size : cell[i]", "par i < size : cell[(i + 200) % 229]"),  # one never runs
        ("par i < size : cell[i]", "par i < size - 1 : cell[i]"),
        ("par i < size : cell[i]", "par i < size : if i == 200 then skip else cell[i]"),
        ("par i < size : cell[i]", "(par i < size : cell[i]) || cell[200]"),  # one runs twice
        ("par i < size : cell[i]", "seq i < size : cell[i]"),
        ("var value : int = 0", "var value : int = 1 / (gain - 200)"),
        ("const size = 230", "const size = 100001"),  # too many
    ],
)
def test_what_differs_in_one_element_is_found(written: str, instead: str) -> None:
    assert is_decided_by_fewer(CHAIN)
    assert written in CHAIN
    changed = CHAIN.replace(written, instead)
    if "gain - 200" in instead:
        changed = changed.replace("cell[size] : Cell", "cell[i < size] : Cell(gain = i)")
    assert found_in(changed).report.has_errors or "seq" in instead
    assert not is_decided_by_fewer(changed)


@pytest.mark.parametrize(
    ("written", "instead"),
    [
        ("output ! value", "output ! value % size"),
        ("cell[size] : Cell", "cell[i < size] : Cell(gain = size - 1 - i)"),
        ("(i + 1) % size", "(i + size - 1) % size"),
        ("(i + 1) % size", "(i + 2) % size"),
        ("cell[(i + 1) % size].input", "overwrite 1 -> cell[(i + 1) % size].input"),
        ("const size = 230", "const rows = 15\nconst columns = 230\nconst size = rows * columns"),
    ],
)
def test_what_differs_by_the_index_alone_is_decided_by_fewer(written: str, instead: str) -> None:
    assert written in CHAIN
    assert is_decided_by_fewer(CHAIN.replace(written, instead))


def test_an_element_that_is_related_to_itself_in_another_way_is_found() -> None:
    """Two parts of one repetition are in sequence, those of two repetitions in parallel."""
    program = CHAIN.replace("par i < size : cell[i]", "par i < size : (cell[i] ; other[i])")
    program = program.replace("cell[size] : Cell\n", "cell[size] : Cell\n    other[size] : Cell\n")
    program = program.replace(
        "(i + 1) % size].input", "(i + 1) % size].input\n      other[i].output -> other[INDEX].input"
    )
    for index in ("(i + 1) % size", "i", "(i + 200) % size"):
        for cells in ("(i + 1) % size", "i"):
            text = program.replace("INDEX", index).replace("cell[(i + 1) % size]", f"other[{cells}]")
            is_decided_by_fewer(text)
