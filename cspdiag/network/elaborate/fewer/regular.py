"""Whether a program with many elements has the network that follows from those with few and with some more.

What an element is in the network depends on its neighbourhood, on the indexes of what it is connected to, on where the
composition runs it, and on its arguments. All of these are known for each element as columns of numbers, which take
little time also for many elements. So they are computed for all three programs: if those of the large one are what
follows from the other two, then so is its network.
"""

from __future__ import annotations

from collections.abc import Iterable

from cspdiag.model.program import Program, Value
from cspdiag.network.elaborate.definitions import Definitions
from cspdiag.network.elaborate.fewer.extrapolation import Extrapolation, IrregularError
from cspdiag.network.elaborate.fewer.neighbourhoods import Colours, Columns, Neighbourhoods, UnknownError
from cspdiag.network.elaborate.fewer.varying import Varying
from cspdiag.syntax import ast
from cspdiag.syntax.walk import nodes


def is_regular(few: Program, some: Program, many: Program, varying: Varying, extrapolation: Extrapolation) -> bool:
    """Whether the network of a program with ``many`` elements, as it is lowered, follows from those with fewer."""
    processes = [item for item in many.definitions.values() if isinstance(item, ast.ProcessDefinition)]
    if not all(_counts_at_most(many, varying, value) for value in _values(processes)):
        return False
    colours = Colours()
    try:
        one, other, all_ = (_numbers(program, many, varying, colours) for program in (few, some, many))
        return extrapolation.of(one, other) == all_
    except (UnknownError, IrregularError):
        return False


def _values(processes: Iterable[ast.ProcessDefinition]) -> Iterable[ast.Expression]:
    """The values that processes communicate and assign."""
    for part in nodes(*processes):
        if isinstance(part, ast.Write | ast.Assign | ast.OutputGuard):
            yield part.value


def _counts_at_most(program: Program, varying: Varying, value: ast.Expression) -> bool:
    """Whether what varies in a value is at most the value itself or one term of it. Anything else might be computed
    in another way for one element than for its neighbours.
    """
    terms = (value.left, value.right) if isinstance(value, ast.Binary) and value.operator == "+" else (value,)
    differing = [term for term in terms if varying.is_in(program, (term,))]
    return not differing or (len(differing) == 1 and isinstance(differing[0], ast.Name))


def _numbers(
    program: Program, many: Program, varying: Varying, colours: Colours
) -> tuple[tuple[Value, ...], tuple[Columns, ...]]:
    """All that varies between programs of different sizes. Raises UnknownError."""
    around = Neighbourhoods(program, Definitions(program), varying, colours)
    constants = tuple([program.constants[constant] for constant in many.constants])
    return constants, tuple(map(around.columns_of, varying.definitions))
