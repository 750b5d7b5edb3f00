"""The step of continuous states that move by a matrix, in an environment."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from textwrap import wrap

from cspdiag.base.record import record
from cspdiag.codegen.python.plain.expressions import Printer
from cspdiag.codegen.python.text.code import PRODUCT, SUM, Code, Constant, Name, call, tuple_of
from cspdiag.codegen.python.text.imports import Imports
from cspdiag.codegen.python.text.layout import LINE_LENGTH
from cspdiag.codegen.python.text.names import Names
from cspdiag.codegen.python.text.operators import infix, infix_all
from cspdiag.codegen.python.text.statements import Remark, Statement, assign, unpack
from cspdiag.network.ir.equations import LinearBlock
from cspdiag.network.ir.expressions import Expression
from cspdiag.network.ir.network import SubmodelClass

MatrixEntry = Callable[[int, int], Code]
"""The entry of a matrix in a row and a column."""


@record
class LinearStep:
    """Writes what concerns one block. ``names`` gives the Python names of its states, which are local variables;
    ``a``, ``m`` and ``n`` are the names of the matrices.
    """

    block: LinearBlock
    names: Names
    a: str
    m: str
    n: str

    def described(self) -> Iterable[Remark]:
        """What A is."""
        states = ", ".join(self.names[state] for state in self.block.states)
        text = f"dx/dt = {self.a} x + r, where r is held between two instants, x = ({states})"
        return map(Remark, wrap(text, LINE_LENGTH - 2))

    def coefficients(self, printer: Printer) -> Code:
        """A."""

        def entry(part: Expression | None) -> Code:
            return Constant("0.0") if part is None else printer.print(part)

        return tuple_of(tuple_of(entry(part) for part in row) for row in self.block.matrix)

    def matrices(self, a: Code, imports: Imports) -> Statement:
        """The assignment of M and N for a step of ``h`` seconds."""
        rows = self.block.rows
        has_products = any(len(row.of) > row.keeps for row in rows)
        read = [Name(self.m if has_products else "_"), Name(self.n if any(row.held for row in rows) else "_")]
        return unpack(read, call(imports.runtime("rk4_matrices"), a, Name("h")))

    def moved(self, m: MatrixEntry, n: MatrixEntry, printer: Printer) -> Statement:
        """The assignment of ``M x + N r`` to the states, whose sums are from left to right."""
        names = [Name(self.names[state]) for state in self.block.states]
        values: list[Code] = []
        for i, row in enumerate(self.block.rows):
            terms: list[Code] = [
                name if row.keeps and i == j else infix("*", PRODUCT, m(i, j), name)
                for j, name in enumerate(names)
                if j in row.of
            ]
            for j in row.held:
                held = self.block.held[j]
                assert held is not None
                terms.append(infix("*", PRODUCT, n(i, j), printer.print(held)))
            values.append(infix_all("+", SUM, terms))
        return assign(names[0], values[0]) if len(names) == 1 else unpack(names, tuple_of(values))


STEP = Remark("A step of RK4 over h is x = M x + N r.")
"""What M and N are."""


def linear_steps(system: SubmodelClass, names: Names) -> list[LinearStep]:
    """Those of all blocks of a system, with new names."""
    steps = []
    for block in system.linear:
        a, m, n = (names.fresh(f"{block.instance}.{letter}") for letter in "amn")
        steps.append(LinearStep(block, names, a, m, n))
    return steps
