"""The step of continuous states that move by a matrix, in an environment."""

from __future__ import annotations

from cspdiag.base.record import record
from cspdiag.codegen.c.text.code import PRODUCT, SUM, Atom, Code, address, call, code, infix, own
from cspdiag.codegen.c.text.expressions import Printer
from cspdiag.codegen.c.text.names import Names
from cspdiag.codegen.c.text.statements import For, Plain, Statement, define, run, store
from cspdiag.network.ir.equations import LinearBlock
from cspdiag.network.ir.network import SubmodelClass


@record
class LinearStep:
    """Writes what concerns one block. ``names`` gives the C names of its states, which are local variables; ``block``
    is a member of the struct of the environment, ``step`` a local variable for M and N, ``following`` are those for the
    next values of the states.
    """

    linear: LinearBlock
    names: Names
    block: str
    step: str
    following: tuple[str, ...]

    def declaration(self) -> Plain:
        """The member for A, and for M and N."""
        states = ", ".join(self.names[state] for state in self.linear.states)
        about = f"dx/dt = A x + r, where r is held between two instants, x = ({states})"
        return define("csp_linear", self.block, remark=about)

    def start(self, printer: Printer) -> list[Statement]:
        """The statements that compute A."""
        count = len(self.linear.states)
        statements: list[Statement] = [run(call("csp_linear_start", address(own(self.block)), f"{count}U"))]
        for i, row in enumerate(self.linear.matrix):
            for j, entry in enumerate(row):
                if entry is not None:
                    value = printer.evaluate(entry)
                    statements += value.setup
                    statements.append(store(own(self.block).field("a").at(i).at(j), value.code))
        return statements

    def moved(self, printer: Printer, count: Code | None) -> list[Statement]:
        """The steps of the states, which are local variables, ``count`` of them if there is more than one."""
        found = call("csp_linear_step", address(own(self.block)), "h")
        statements: list[Statement] = [define("const csp_rk4 *const", self.step, found)]
        states = [code(self.names[state]) for state in self.linear.states]
        body: list[Statement] = []
        for i, (following, row) in enumerate(zip(self.following, self.linear.rows, strict=True)):
            terms = [self._entry("m", i, j, states[j]) if not (row.keeps and i == j) else states[j] for j in row.of]
            for j in row.held:
                held = self.linear.held[j]
                assert held is not None
                terms.append(self._entry("n", i, j, printer.evaluate(held).code))
            total = terms[0]
            for term in terms[1:]:
                total = infix("+", SUM, total, term)
            body.append(define("const double", following, total))
        body += [store(state, following) for state, following in zip(states, self.following, strict=True)]
        return [*statements, *(body if count is None else [_repeated(count, body)])]

    def _entry(self, matrix: str, row: int, column: int, factor: Code) -> Code:
        return infix("*", PRODUCT, code(self.step).arrow(matrix).at(row).at(column), factor)


def _repeated(count: Code, body: list[Statement]) -> Statement:
    return For(Atom("step"), count, tuple(body), type_name="int64_t")


def linear_steps(system: SubmodelClass, names: Names) -> list[LinearStep]:
    """Those of all blocks of a system, with new names."""
    return [
        LinearStep(
            block,
            names,
            names.fresh(f"{block.instance}.linear"),
            names.fresh(f"{block.instance}.step"),
            tuple(names.fresh(f"{state}.next") for state in block.states),
        )
        for block in system.linear
    ]
