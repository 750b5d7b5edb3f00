"""Which continuous states of an environment move by a matrix: those whose derivatives are linear in them, with known
coefficients, and with inputs that are held between two instants.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence

from cspdiag.base import Span
from cspdiag.base.record import record
from cspdiag.model.types import DOUBLE, is_double
from cspdiag.network.ir.equations import LinearBlock, SubmodelEquation
from cspdiag.network.ir.expression_walk import signals_read
from cspdiag.network.ir.expressions import Expression, LiteralValue, SignalValue
from cspdiag.network.submodels.draft import Draft
from cspdiag.network.submodels.linear_form import ONE, LinearForm, LinearForms, NotLinearError

MOST_STATES = 8
"""The number of states that a matrix may have: a larger one is computed from its derivatives."""


def linear_blocks(
    draft: Draft, equations: Sequence[SubmodelEquation], derivatives: Mapping[str, Expression]
) -> tuple[LinearBlock, ...]:
    """The blocks of a draft. ``equations`` are those that change during a step, in order.

    States belong together if a derivative of one reads another, directly or through equations, or if both read an
    equation that changes; so nothing outside a block moves with it. A block is linear as a whole or not at all.
    """
    if not draft.closed or draft.sample is None:
        return ()
    longest = min(draft.sample, *draft.steps) if draft.steps else draft.sample
    blocks: list[LinearBlock] = []
    for part in _parts(equations, derivatives):
        if len(part.derivatives) > MOST_STATES:
            continue
        try:
            block = _block(draft, part, frozenset({*derivatives, *(item.name for item in equations)}))
        except NotLinearError:
            continue
        if _stays_finite(draft, block, longest / 1_000_000_000):
            blocks.append(block)
    return tuple(blocks)


@record
class _Part:
    """States that belong together, and the equations between them, in order."""

    derivatives: dict[str, Expression]
    equations: tuple[SubmodelEquation, ...]


def _parts(equations: Sequence[SubmodelEquation], derivatives: Mapping[str, Expression]) -> Iterator[_Part]:
    leader = {name: name for name in (*derivatives, *(item.name for item in equations))}

    def leading(name: str) -> str:
        while leader[name] != name:
            leader[name] = leader[leader[name]]
            name = leader[name]
        return name

    reads: Iterable[tuple[str, Iterable[str]]] = (
        *((item.name, item.reads) for item in equations),
        *((name, signals_read(value)) for name, value in derivatives.items()),
    )
    for name, read in reads:
        for other in read:
            if other in leader:
                leader[leading(name)] = leading(other)
    states: dict[str, dict[str, Expression]] = {}
    for name, value in derivatives.items():
        states.setdefault(leading(name), {})[name] = value
    between: dict[str, list[SubmodelEquation]] = {}
    for item in equations:
        between.setdefault(leading(item.name), []).append(item)
    for root, found in states.items():
        yield _Part(found, tuple(between.get(root, ())))


def _block(draft: Draft, part: _Part, moving: frozenset[str]) -> LinearBlock:
    """The block of these states. Raises NotLinearError."""
    if not all(is_double(draft.states[name].type) for name in part.derivatives):
        raise NotLinearError
    forms = LinearForms(
        {name: LinearForm({name: ONE}, None) for name in part.derivatives}, moving, draft.value_of, draft.probed
    )
    equations: list[SubmodelEquation] = []
    for item in part.equations:
        form = forms.form(item.value)
        if isinstance(form, LinearForm):
            if not is_double(item.type):
                raise NotLinearError
            form = LinearForm(form.terms, _computed_once(draft, form.rest, item.name, item.span, equations))
        forms.known[item.name] = form
    rows: list[tuple[Expression | None, ...]] = []
    held: list[Expression | None] = []
    for name, value in part.derivatives.items():
        form = forms.form(value)
        if isinstance(form, tuple) or not is_double(value.type):
            raise NotLinearError
        rows.append(tuple(form.terms.get(state) for state in part.derivatives))
        held.append(_computed_once(draft, form.rest, name, draft.changes[name], equations))
    return LinearBlock(states=tuple(part.derivatives), matrix=tuple(rows), equations=tuple(equations), held=tuple(held))


def _computed_once(
    draft: Draft, value: Expression | None, name: str, span: Span, equations: list[SubmodelEquation]
) -> Expression | None:
    """What is held of the signal ``name``, as a signal if it has to be computed."""
    if value is None or isinstance(value, SignalValue | LiteralValue):
        return value
    local = draft.unique(f"{name}_held")
    equations.append(SubmodelEquation(name=local, type=DOUBLE, value=value, span=span))
    return SignalValue(type=DOUBLE, name=local)


def _stays_finite(draft: Draft, block: LinearBlock, h: float) -> bool:
    """Whether all coefficients are known and finite, and M and N of their absolute values are finite for a step of
    ``h`` seconds: then M and N are for every shorter step.
    """
    sizes = [[0.0 if entry is None else _size(draft, entry) for entry in row] for row in block.matrix]
    every = range(len(sizes))
    z = [[h * size for size in row] for row in sizes]

    def product(s: list[list[float]]) -> list[list[float]]:
        return [[sum(z[i][k] * s[k][j] for k in every) for j in every] for i in every]

    s = [[float(i == j) for j in every] for i in every]
    for divisor in (4.0, 3.0, 2.0):
        s = [[(i == j) + entry / divisor for j, entry in enumerate(row)] for i, row in enumerate(product(s))]
    n = [[h * entry for entry in row] for row in s]
    return all(math.isfinite(entry) for row in (*sizes, *n, *product(s)) for entry in row)


def _size(draft: Draft, coefficient: Expression) -> float:
    value = draft.probed(coefficient)
    return abs(value) if isinstance(value, float) else math.nan
