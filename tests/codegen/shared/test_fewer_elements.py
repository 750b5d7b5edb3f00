"""Code of many elements that is made from fewer of them is that made element by element."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Literal, TypeAlias

import pytest

from cspdiag import pipeline
from cspdiag.base.record import replaced
from cspdiag.base.sources import read_source
from cspdiag.base.span import SourceFile
from cspdiag.network.ir.network import CoreNetwork
from tests.support.unrolled import forms

NETWORKS = Path(__file__).parents[3] / "benchmarks" / "networks"
SIZE = 230
"""More than are always compiled one by one."""


@pytest.fixture(autouse=True)
def few_are_many(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pipeline, "LEAST_TO_CONTINUE", 0)


Way: TypeAlias = Literal["fewer", "all after passes", "all", "none"]
"""Whether code is made from fewer elements, from all of them, from all of them since passes do not do the same with
fewer ones, or not at all.
"""


Form: TypeAlias = tuple[str, int]
"""A target and a level of optimization."""

FORMS: tuple[Form, ...] = (("python", 0), ("python", 1), ("c", 0), ("c", 1))


def way(text: str, wanted: Sequence[Form] = FORMS[1:2], settings: Mapping[str, str] | None = None) -> Way:
    """How code is made; it has to be that made from all elements."""
    source = SourceFile(name="main.csp", text=text)
    fewer, all_ = (
        pipeline.build(source, read_source, settings=settings, for_code=for_code) for for_code in (True, False)
    )
    messages = [[found.message for found in built.checked.report.diagnostics] for built in (fewer, all_)]
    assert messages[0] == messages[1]
    if fewer.network is None or all_.network is None:
        assert fewer.network is all_.network
        return "none"
    if fewer.network.fewer is None:
        return "all"
    needed = [compared(fewer.network, all_.network, *form) for form in wanted]
    return "all after passes" if any(needed) else "fewer"


def compared(network: CoreNetwork, all_: CoreNetwork, target: str, level: int) -> bool:
    """Whether the network of all elements was needed after all."""
    needed: list[CoreNetwork] = []

    def whole() -> CoreNetwork:
        needed.append(all_)
        return all_

    assert network.fewer is not None
    network = replaced(network, fewer=replaced(network.fewer, whole=whole))
    made = pipeline.generate(network, read_source, target, level)
    assert made == pipeline.generate(all_, read_source, target, level)
    return bool(needed)


def network(name: str, size: int = SIZE) -> str:
    text = (NETWORKS / f"{name}.csp").read_text(encoding="utf-8")
    return re.sub(r"const (size|number|seats|joints) = \d+", rf"const \1 = {size}", text)


@pytest.mark.parametrize("name", ["ring", "pipeline", "workers", "star", "scheduler"])
def test_networks_are_compiled_from_fewer_elements(name: str) -> None:
    assert way(network(name), FORMS) == ("all" if name == "scheduler" else "fewer")
    assert way(network(name, 30)) == "all"


@pytest.mark.parametrize("form", FORMS[1::2])
def test_many_more_elements_are_compiled_from_fewer_ones(form: Form) -> None:
    assert way(network("ring", 1200), [form]) == "fewer"


@pytest.mark.parametrize("form", FORMS[1::2])
def test_programs_with_mistakes_anywhere_are_compiled_as_all_elements_are(form: Form) -> None:
    ways = [way(forms(seed)[0](SIZE), [form]) for seed in range(20)]
    assert ways.count("fewer") > 3
    assert ways.count("all") > 1


PROGRAM = """
const size = 230
const few = 3

process Cell(gain: int = 1) {
  in  input  : int
  out output : int

  communication {
    var value : int = 0
  }

  composition {
    mu (input ? value ; output ! value + gain)
  }
}

process Server {
  in  request[size] : int
  out reply[size]   : int

  communication {
    var question : int
  }

  composition {
    mu (alt i < size : request[i] ? question -> reply[i] ! question % 1000 + i)
  }
}

process Ring {
  communication {
    cell[i < size] : Cell(gain = i)
    client[size]   : Cell
    server         : Server
    others[few]    : Cell

    for i < size {
      cell[i].output   -> cell[(i + 1) % size].input
      client[i].output -> server.request[i]
      server.reply[i]  -> client[i].input
    }
    for i < few {
      others[i].output -> others[(i + 1) % few].input
    }
  }

  composition {
    (par i < size : (cell[i] || client[i])) || server || (par i < few : others[i])
  }
}
"""


@pytest.mark.parametrize(
    ("written", "instead"),
    [
        ("", ""),
        ("output ! value + gain", "output ! gain"),
        ("(gain = i)", "(gain = 3 * i + 7)"),
        ("(gain = i)", "(gain = size + i)"),
        ("(gain = i)", "(gain = few)"),
        ("(i + 1) % size", "(i + size - 1) % size"),
        ("cell[i].output   -> ", "cell[i].output   -> buffer 2 -> "),
        ("question % 1000 + i", "question"),
        ("question % 1000 + i", "size"),
        ("par i < size : (cell[i] || client[i])", "(par i < size : client[i]) || (par i < size : cell[i])"),
        ("par i < size : (cell[i] || client[i])", "par i < size : (skip ; (client[i] || cell[i]))"),
    ],
)
def test_what_differs_by_the_index_alone_is_compiled_from_fewer_elements(written: str, instead: str) -> None:
    assert written in PROGRAM
    assert way(PROGRAM.replace(written, instead)) == "fewer"


@pytest.mark.parametrize(
    ("written", "instead"),
    [
        ("(i + 1) % size", "(i + 100) % size"),
        ("(gain = i)", "(gain = i / 100)"),
        ("(gain = i)", "(gain = i % 100)"),
        ("(gain = i)", "(gain = i * i)"),
        ("(gain = i)", "(gain = size / 100)"),
        ("(gain = i)", "(gain = i - 215)"),
        ("(gain = i)", "(gain = size - 1 - i)"),  # one is zero, as the first is with fewer
        ("value + gain", "value * gain"),
        ("value + gain", "value + 2 * gain"),
        ("question % 1000 + i", "question + i / 100"),
        ("question % 1000 + i", "question + (i - 100)"),
        ("question % 1000 + i", "question % size"),
        ("few = 3", "few = 230"),
    ],
)
def test_what_may_be_irregular_is_compiled_element_by_element(written: str, instead: str) -> None:
    assert written in PROGRAM
    assert way(PROGRAM.replace(written, instead)) == "all"


@pytest.mark.parametrize(
    ("written", "instead"),
    [
        ("value + gain", "value % 9223372036854775600 + gain"),
        ("question % 1000 + i", "base + i"),
    ],
)
def test_where_only_many_elements_overflow_passes_get_all_of_them(written: str, instead: str) -> None:
    program = PROGRAM.replace("    var question", "    var base     : int = 9223372036854775600\n    var question")
    program = program if "base" in instead else PROGRAM
    assert written in program
    assert way(program.replace(written, instead)) == "all after passes"


CELL = """
process Cell {
  in  input  : int
  out output : int
  communication {
    var value : int
  }
  composition {
    mu (input ? value ; output ! value)
  }
}
"""

GRID = """
const rows = 5
const columns = 230
const size = rows * columns
process Grid {
  communication {
    cell[size] : Cell
    for r < rows {
      for c < columns {
        cell[r * columns + c].output -> cell[r * columns + (c + 1) % columns].input
      }
    }
  }
  composition {
    par i < size : cell[i]
  }
}
"""

PAIRS = """
const size = 230
process Pair {
  in  input  : int
  out output : int
  communication {
    first  : Cell
    second : Cell
    input -> first.input
    first.output -> second.input
    second.output -> output
  }
  composition {
    first || second
  }
}

process Ring {
  communication {
    pair[size] : Pair
    for i < size {
      pair[i].output -> pair[(i + 1) % size].input
    }
  }
  composition {
    par i < size : pair[i]
  }
}
"""

HUBS = """
const size = 230
const each = 3
process Hub {
  out output[each] : int
  in  input[each]  : int
  communication {
    var value : int = 0
  }
  composition {
    mu ((seq k < each : output[k] ! value) ; (seq k < each : input[k] ? value))
  }
}

process Hubs {
  communication {
    hub[size]          : Hub
    cell[size * each]  : Cell
    for i < size {
      for k < each {
        hub[i].output[k] -> cell[each * i + k].input
        cell[each * i + k].output -> hub[i].input[k]
      }
    }
  }
  composition {
    (par i < size : hub[i]) || (par i < size * each : cell[i])
  }
}
"""


@pytest.mark.parametrize("text", [GRID, PAIRS, HUBS], ids=["grid", "pairs", "hubs"])
def test_arrays_inside_and_indexes_of_two_loops_follow_from_fewer_elements(text: str) -> None:
    assert way(text + CELL) == "fewer"


THIRDS = """
const size = 230
process Cell {
  in input : int
  communication {
    var value : int
  }
  composition {
    mu input ? value
  }
}
process Source {
  out output : int
  composition {
    mu output ! 1
  }
}
process Thirds {
  communication {
    source[3 * size] : Source
    cell[3 * size]   : Cell
    for i < size {
      source[i].output -> cell[i].input
      source[size + i].output -> cell[size + i].input
      source[2 * size + i].output -> cell[2 * size + i].input
    }
  }
  composition {
    (par i < 3 * size : source[i]) || (par i < 3 * size : cell[i])
  }
}
"""


@pytest.mark.parametrize(
    "middle",
    [
        "source[size + i].output -> cell[2 * size - 1 - i].input",
        "source[2 * size - 1 - i].output -> cell[size + i].input",
        "source[size + i].output -> buffer 2 -> cell[size + i].input",
        "source[size + i].output -> buffer 2 -> cell[2 * size - 1 - i].input",
    ],
)
def test_elements_in_the_middle_of_an_array_that_differ_are_compiled_from_fewer_elements(middle: str) -> None:
    usual = "source[size + i].output -> cell[size + i].input"
    assert usual in THIRDS
    assert way(THIRDS.replace(usual, middle), FORMS) == "fewer"


def test_branches_of_a_parallel_that_are_more_than_an_instance_are_compiled_from_fewer_elements() -> None:
    separate = "(par i < 3 * size : source[i]) || (par i < 3 * size : cell[i])"
    assert separate in THIRDS
    assert way(THIRDS.replace(separate, "par i < 3 * size : (source[i] || cell[i])"), FORMS[2:]) == "fewer"


def test_a_size_that_is_set_is_compiled_from_fewer_elements() -> None:
    assert way(network("ring", 30), settings={"size": "300"}) == "fewer"


def test_a_few_hundred_elements_are_compiled_sooner_one_by_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.undo()
    assert way(network("ring"), ()) == "all"
    built = pipeline.build(SourceFile(name="main.csp", text=network("ring", 10_000)), read_source, for_code=True)
    assert built.network is not None
    assert built.network.fewer is not None
