"""Lists of channels and instances: what is made of a few elements is what all elements say."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from random import Random

import pytest

from cspdiag import pipeline
from cspdiag.base.sources import read_source
from cspdiag.base.span import SourceFile
from cspdiag.codegen.python.plain import constructors
from cspdiag.codegen.python.plain.instances import Instances
from cspdiag.codegen.python.text.code import Argument, Call, Code, Name, WholeNumber
from cspdiag.codegen.python.text.rolling import rolled_list, rolled_rows
from cspdiag.codegen.shared.trees import Outline, Stretch, outline, stretches
from cspdiag.network.ir.network import InstanceOf

NETWORKS = Path(__file__).parents[3] / "benchmarks" / "networks"

UNEVEN = """
const size = 40
const base = 7

process Cell(gain: int, offset: int, factor: double) {
  in  input    : int = 3
  in  extra[2] : int
  out output   : int

  communication {
    var value : int
    var more  : int
  }

  composition {
    mu (input ? value ; extra[0] ? more ; extra[1] ? value ; output ! (value + gain + offset) % 9 ; skip)
  }
}

process Source {
  out output : int

  composition {
    mu output ! 1
  }
}

process Sink {
  in input : int

  communication {
    var value : int
  }

  composition {
    mu input ? value
  }
}

process Uneven {
  communication {
    first[3 * size / 2] : Source
    second[size]     : Source
    cell[i < size]   : Cell(gain = if i == 9 then base else i - 5, offset = 3, factor = if i < 20 then 1.5 else 2.5)
    sink[size]       : Sink

    for i < size {
      first[i].output -> cell[i].extra[0]
      second[(i + 7) % size].output -> cell[i].extra[1]
      cell[i].output -> sink[size - 1 - i].input
    }
    for i < size / 2 {
      first[size + i].output -> cell[i].input
    }
  }

  composition {
    (par i < size : (first[i] || cell[i] || second[i]))
    || (par i < size : sink[i])
    || (par i < size / 2 : first[size + i])
  }
}
"""


@pytest.mark.parametrize("level", [0, 1])
@pytest.mark.parametrize("name", ["uneven", "ring", "pipeline", "workers", "star"])
def test_lists_are_what_all_elements_say(name: str, level: int, monkeypatch: pytest.MonkeyPatch) -> None:
    if name == "uneven":
        source = SourceFile(name="uneven.csp", text=UNEVEN)
    else:
        text = (NETWORKS / f"{name}.csp").read_text(encoding="utf-8")
        source = SourceFile(name=f"{name}.csp", text=text.replace("const size = 10\n", "const size = 40\n"))
    built = pipeline.build(source, read_source)
    assert built.network is not None, built.checked.report.diagnostics
    network = built.network
    few = pipeline.generate(network, read_source, "python", level)

    def from_all(rows: Sequence[Stretch], made: Callable[[int], Code], variable: str) -> Code:
        return rolled_list([made(position) for position in range(sum(row.count for row in rows))], variable)

    monkeypatch.setattr(constructors, "rolled_rows", from_all)
    assert few == pipeline.generate(network, read_source, "python", level)


def test_elements_are_made_where_their_rows_leave_them_open() -> None:
    elements: list[Code] = [Call(Name("Cell"), (Argument(WholeNumber(value)),)) for value in (0, 1, 5, 3, 4)]
    ambiguous = [Outline("Cell", (position, value)) for position, value in enumerate((0, 1, 5, 3, 4))]
    assert rolled_rows(stretches(ambiguous), elements.__getitem__, "i") == rolled_list(elements, "i")
    elements[-1] = Name("other")
    assert rolled_rows(stretches(ambiguous), elements.__getitem__, "i") == rolled_list(elements, "i")


def test_stretches_say_what_each_of_their_outlines_says() -> None:
    rng = Random(13)
    for _ in range(300):
        pieces = [
            (rng.randrange(12), rng.choice((-1, 0, 1, 1, 2)), rng.randrange(1, 7)) for _ in range(rng.randrange(1, 5))
        ]
        values = [abs(first + step * position) for first, step, count in pieces for position in range(count)]
        elements: list[Code] = [Call(Name("cell"), (Argument(WholeNumber(value)),)) for value in values]
        singly = [outline(element) for element in elements]
        made = rolled_rows(stretches(singly), elements.__getitem__, "i")
        assert eval(made.flat, {"cell": int}) == values
        one_by_one = [stretch for row in singly for stretch in stretches([row])]
        assert rolled_rows(one_by_one, elements.__getitem__, "i") == made


def test_of_rows_that_are_known_to_count_three_are_made() -> None:
    text = (NETWORKS / "ring.csp").read_text(encoding="utf-8").replace("const size = 1000\n", "const size = 2000\n")
    built = pipeline.build(SourceFile(name="ring.csp", text=text), read_source, for_code=True)
    assert built.network is not None
    with pytest.MonkeyPatch.context() as patched:
        asked: list[str] = []
        row = Instances.row

        def noted(self: Instances, instance: InstanceOf) -> Outline:
            asked.append(instance.name)
            return row(self, instance)

        patched.setattr(Instances, "row", noted)
        pipeline.generate(built.network, read_source, "python", 1)
    assert len(asked) < 10
