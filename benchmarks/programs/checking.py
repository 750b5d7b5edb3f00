"""Checking and compiling models of any size: chains of cells, one line per instance."""

from __future__ import annotations

import time

from timing import BATCHES, report, requested_benchmark, size_of

from cspdiag.base import SourceFile
from cspdiag.codegen.python.package import generate
from cspdiag.pipeline import build, check

CELL = """
process Cell {
  in  input  : int
  out output : int
  communication { var value : int }
  composition { mu (input ? value ; output ! value) }
}
"""


def model(lines: int) -> str:
    """About ``lines`` lines: one third each of instances, relationships, and their names in the composition."""
    cells = lines // 3
    instances = "\n".join(f"    cell{index} : Cell" for index in range(cells))
    relationships = "\n".join(f"    cell{index}.output -> cell{(index + 1) % cells}.input" for index in range(cells))
    composition = "\n    || ".join(f"cell{index}" for index in range(cells))
    return (
        f"{CELL}\nprocess Ring {{\n  communication {{\n{instances}\n{relationships}\n  }}\n  composition {{\n    "
        f"{composition}\n  }}\n}}\n"
    )


def nothing_to_read(path: str) -> SourceFile:
    raise FileNotFoundError(path)


source = SourceFile(name="ring.csp", text=model(size_of(requested_benchmark())))
for _ in range(BATCHES):
    began = time.perf_counter()
    if requested_benchmark().startswith("check"):
        checked = check(source, nothing_to_read)
    else:
        built = build(source, nothing_to_read)
        assert built.network is not None
        generate(built.network)
    report((time.perf_counter() - began) * 1e3)
