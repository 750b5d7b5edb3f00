"""Whether the elements of all arrays can be exchanged for one another.

Their index is a scalarset (Ip and Dill, "Better verification through symmetry", 1996): it only chooses the element of
an array with this index, so nothing distinguishes elements but being the same or not.
"""

from __future__ import annotations

from cspdiag.model.program import Program
from cspdiag.network.elaborate.fewer.columns import known
from cspdiag.network.elaborate.fewer.decisions import values_passed_on
from cspdiag.network.elaborate.fewer.sizes import FEW, counts_in
from cspdiag.network.elaborate.fewer.varying import Varying
from cspdiag.syntax import ast
from cspdiag.syntax.walk import names, nodes

MOST_REPLICATORS = FEW // 2
"""With more replicators a process might name more elements at a time than the smaller program has."""


def are_interchangeable(program: Program, varying: Varying) -> bool:
    """Whether all arrays that vary have the same size, every replicator goes through all of their elements, and its
    index is used for nothing but the element of that index and values that are passed on.
    """
    parts = [*nodes(*varying.definitions)]
    counts = [count for part in parts for count in counts_in(part) if varying.is_in(program, (count,))]
    if len({known(program, count) for count in counts}) != 1 or known(program, counts[0]) is None:
        return False
    allowed: set[ast.Node] = {*names((*counts, *values_passed_on(parts)))}
    replicators = 0
    for part in parts:
        match part:
            case ast.Replicator():
                replicators += 1
            case ast.Reference(indexes=indexes, member_indexes=inner):
                for index in (*indexes, *inner):
                    if not _is_index_of_all(program, varying, index):
                        return False
                    allowed.add(index)
            case ast.Instance(arguments=arguments):
                allowed.update(names(argument.value for argument in arguments))
            case _:  # Other nodes choose no element.
                pass
    return replicators <= MOST_REPLICATORS and all(
        part in allowed
        for part in parts
        if isinstance(part, ast.Name) and program.bindings.get(part) in varying.symbols
    )


def _is_index_of_all(program: Program, varying: Varying, index: ast.Expression) -> bool:
    symbol = program.bindings.get(index) if isinstance(index, ast.Name) else None
    return isinstance(symbol, ast.Replicator) and symbol in varying.symbols
