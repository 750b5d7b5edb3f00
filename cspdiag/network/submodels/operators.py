"""Realizes operators with memory by states and difference equations.

First-order operators have closed forms, which become constants of the submodel (``speed_b0 = sample / (2 * tau +
sample)``), so generated code shows them. The coefficients of transfer functions and state spaces are computed by
``discretize``.

Each operator is realized so that ``y`` (its output) depends on its input within the sample only if its discretization
has a direct feedthrough: ``tustin`` and ``backward`` have one, ``zoh`` and ``euler`` do not (for strictly proper
operators).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import get_args

from cspdiag.base import Report, Span
from cspdiag.base.record import node
from cspdiag.model.types import ArrayType, RealType, Type
from cspdiag.model.wording import counted
from cspdiag.network.diagnostics.operators import (
    ImproperTransfer,
    NotDiscretized,
    UnstableDiscretization,
    ValueOutOfRange,
    WrongShape,
)
from cspdiag.network.ir.expression_parts import call, entry, minus, number, of_width, over, plus, times
from cspdiag.network.ir.expressions import (
    ArrayElements,
    Expression,
    LiteralValue,
    ParameterValue,
    SignalValue,
    TunableValue,
)
from cspdiag.network.ir.network import SubmodelState
from cspdiag.network.submodels.discretize import Method, missing_package
from cspdiag.network.submodels.draft import Draft, LinearOperator

LONGEST_DELAY = 10_000

PARAMETERS = {
    "pre": ("x", "init"),
    "delay": ("x", "n", "init"),
    "integral": ("x", "init"),
    "derivative": ("x",),
    "lag": ("x", "tau"),
    "transfer": ("num", "den", "x"),
    "statespace": ("A", "B", "C", "D", "x"),
}
"""The operators with memory and the names of their arguments; those without ``init`` start from zero."""


@node
class Application:
    """An application of an operator: ``output`` is the name of the signal of its value, ``base`` the prefix of the
    names of its states.
    """

    operator: str
    arguments: dict[str, Expression]
    output: str
    base: str
    type: Type
    method: Method
    span: Span

    @property
    def y(self) -> Expression:
        """The present output."""
        return SignalValue(type=self.type, name=self.output)

    @property
    def scalar(self) -> Type:
        """The type of coefficients: a dimensionless number as wide as the output."""
        return RealType(self.type.bits) if isinstance(self.type, RealType) else RealType()


def realize(draft: Draft, application: Application, report: Report) -> Expression | None:
    """Adds the states of an operator to the draft; returns the value of its output, None if an error was reported."""
    return _REALIZATIONS[application.operator](draft, application, report)


def _simple(draft: Draft, use: Application, name: str, value: Expression) -> Expression:
    """``value`` if it may be used more than once, otherwise a signal with that value."""
    if isinstance(value, SignalValue | ParameterValue | TunableValue | LiteralValue):
        return value
    chosen = draft.unique(f"{use.base}_{name}")
    draft.equation(chosen, value, use.span)
    return SignalValue(type=value.type, name=chosen)


def _state(draft: Draft, use: Application, name: str, kind: Type, initial: Expression) -> SignalValue:
    chosen = draft.unique(name)
    draft.states[chosen] = SubmodelState(name=chosen, type=kind, initial=initial, continuous=False, span=use.span)
    return SignalValue(type=kind, name=chosen)


def _constant(draft: Draft, use: Application, name: str, value: Expression) -> Expression:
    """A named coefficient."""
    chosen = draft.unique(f"{use.base}_{name}")
    draft.equation(chosen, of_width(value, use.type), use.span, kind=use.scalar)
    return SignalValue(type=use.scalar, name=chosen)


def _initial(draft: Draft, use: Application) -> Expression:
    """The argument ``init``; zero if it is missing."""
    return use.arguments.get("init", number(0.0, use.type))


def _pre(draft: Draft, use: Application, report: Report) -> Expression:
    x = use.arguments["x"]
    name = f"{x.name}_previous" if isinstance(x, SignalValue) else f"{use.base}_previous"
    previous = _state(draft, use, name, use.type, _initial(draft, use))
    draft.next_values[previous.name] = x
    return previous


def _delay(draft: Draft, use: Application, report: Report) -> Expression | None:
    count = use.arguments["n"]
    length = draft.value_of(count)
    if length is None and not draft.concrete:
        length = 1
    if length is None:
        return None
    if not isinstance(length, int) or not 1 <= length <= LONGEST_DELAY:
        problem = f"a delay by {length} samples: it must be from 1 to {LONGEST_DELAY}"
        report.add(ValueOutOfRange(count.span or use.span, problem))
        return None
    if length == 1:
        return _pre(draft, use, report)
    kind, initial = ArrayType(use.type, length), _initial(draft, use)
    line = _state(draft, use, f"{use.base}_line", kind, ArrayElements(type=kind, values=(initial,) * length))
    older = tuple(entry(line, index) for index in range(length - 1))
    draft.next_values[line.name] = ArrayElements(type=kind, values=(use.arguments["x"], *older))
    return entry(line, length - 1)


def _integral(draft: Draft, use: Application, report: Report) -> Expression:
    """1/s (Åström and Wittenmark, Computer-Controlled Systems, section 8.3, with s replaced)."""
    sample = of_width(draft.sample_period(), use.type)
    state = _state(draft, use, f"{use.base}_state", use.type, _initial(draft, use))
    if use.method == "tustin":
        half = times(times(number(0.5, use.scalar), sample), use.arguments["x"])
        share = _simple(draft, use, "share", half)
        draft.next_values[state.name] = plus(use.y, share)
        return plus(state, share)
    area = times(sample, use.arguments["x"])
    if use.method == "backward":
        draft.next_values[state.name] = use.y
        return plus(state, area)
    draft.next_values[state.name] = plus(state, area)
    return state


def _derivative(draft: Draft, use: Application, report: Report) -> Expression:
    """The backward difference, whatever the method: tustin would ring at half the sample frequency, euler needs the
    future.
    """
    x = _simple(draft, use, "input", use.arguments["x"])
    sample = of_width(draft.sample_period(), use.type)
    name = f"{x.name}_previous" if isinstance(x, SignalValue) else f"{use.base}_previous"
    previous = _state(draft, use, name, x.type, number(0.0, x.type))
    draft.next_values[previous.name] = x
    return over(minus(x, previous), sample)


def _lag(draft: Draft, use: Application, report: Report) -> Expression:
    """1/(tau*s + 1); zoh is exact for inputs that are constant over the sample."""
    tau, sample = use.arguments["tau"], draft.sample_period()
    value = draft.value_of(tau)
    if isinstance(value, int | float) and value <= 0:
        report.add(
            ValueOutOfRange(tau.span or use.span, f"a lag with a time constant of {value:g} s: it must be positive")
        )
    elif isinstance(value, int | float) and draft.sample is not None and use.method == "euler":
        pole = abs(1 - draft.sample / 1_000_000_000 / value)
        if pole > 1:
            report.add(UnstableDiscretization(use.span, f"{draft.sample / 1_000_000:g} ms", pole))
    u = _simple(draft, use, "input", use.arguments["x"])
    initial = _initial(draft, use)
    twice = times(number(2.0, tau.type), tau)
    if use.method == "tustin":
        b0 = _constant(draft, use, "b0", over(sample, plus(twice, sample)))
        a1 = _constant(draft, use, "a1", over(minus(twice, sample), plus(twice, sample)))
        state = _state(draft, use, f"{use.base}_state", use.type, initial)
        draft.next_values[state.name] = plus(times(b0, u), times(a1, use.y))
        return plus(times(b0, u), state)
    state = _state(draft, use, f"{use.base}_state", use.type, initial)
    if use.method == "backward":
        b0 = _constant(draft, use, "b0", over(sample, plus(tau, sample)))
        draft.next_values[state.name] = use.y
        return plus(state, times(b0, minus(u, state)))
    if use.method == "zoh":
        decay = call("exp", over(minus(number(0.0, sample.type), sample), tau))
        gain = minus(number(1.0, RealType()), decay)
    else:
        gain = over(sample, tau)
    b1 = _constant(draft, use, "b1", gain)
    draft.next_values[state.name] = plus(state, times(b1, minus(u, state)))
    return state


def _transfer(draft: Draft, use: Application, report: Report) -> Expression | None:
    """Direct form II transposed in the delta operator, scaled by the sample period.

    With δ = z - 1 the coefficients of fast sampled systems stay far from cancellation (Middleton and Goodwin, Digital
    Control and Estimation, 1990, chapter 3): y = b0·u + s1, next s_k = s_k + s_(k+1) + b_k·u - a_k·y.
    """
    numerator, denominator = (_without_leading_zeros(use.arguments[name]) for name in ("num", "den"))
    if not _length(numerator) or not _length(denominator) or _is_zero(_first(denominator)):
        report.add(
            WrongShape(use.span, "the first coefficient of the denominator may not be zero, nor a list be empty")
        )
        return None
    zeros, poles = _length(numerator) - 1, _length(denominator) - 1
    if zeros > poles:
        report.add(ImproperTransfer(use.span, zeros, poles))
        return None
    if not _is_discretized(draft, use, report):
        return None
    feedthrough = zeros == poles or use.method in ("tustin", "backward")
    first = 0 if feedthrough else 1
    names = [draft.unique(f"{use.base}_b{k}") for k in range(first, poles + 1)]
    names += [draft.unique(f"{use.base}_a{k}") for k in range(1, poles + 1)]
    coefficients = [draft.derived_parameter(name, use.scalar, None) for name in names]
    _remember(draft, use, (numerator, denominator), names, use.scalar)
    b = dict(zip(range(first, poles + 1), coefficients, strict=False))
    a = dict(zip(range(1, poles + 1), coefficients[len(b) :], strict=True))
    u = _simple(draft, use, "input", use.arguments["x"])
    states = [
        _state(draft, use, f"{use.base}_state" + (f"_{k}" if poles > 1 else ""), use.type, number(0.0, use.type))
        for k in a
    ]
    y = use.y if feedthrough else states[0]
    for k, state in zip(a, states, strict=True):
        value: Expression = plus(state, states[k]) if k < poles else state
        draft.next_values[state.name] = minus(plus(value, times(b[k], u)), times(a[k], y))
    if not states:
        return times(b[0], u)
    return plus(times(b[0], u), states[0]) if feedthrough else states[0]


def _statespace(draft: Draft, use: Application, report: Report) -> Expression | None:
    """x' = x + A·x + B·u, y = C·x + D·u, with A, B, C, D those of the increment over one sample."""
    matrices = tuple(use.arguments[name] for name in ("A", "B", "C", "D"))
    shapes = [_shape(matrix) for matrix in matrices]
    problem = _misfit(shapes)
    if problem:
        report.add(WrongShape(use.span, problem))
        return None
    if not _is_discretized(draft, use, report):
        return None
    (n, _), (_, m), (p, _), _ = (shape for shape in shapes if shape)
    kinds = [ArrayType(ArrayType(RealType(), columns), rows) for rows, columns in ((n, n), (n, m), (p, n), (p, m))]
    names = [draft.unique(f"{use.base}_{letter}") for letter in "abcd"]
    a, b, c, d = (draft.derived_parameter(name, kind, None) for name, kind in zip(names, kinds, strict=True))
    _remember(draft, use, matrices, names, *kinds)
    u = _simple(draft, use, "input", use.arguments["x"])
    inputs = [entry(u, k) for k in range(m)] if isinstance(u.type, ArrayType) else [u]
    if len(inputs) != m:
        report.add(WrongShape(use.span, f"B has {counted(m, 'column')}, but x is of {counted(len(inputs), 'input')}"))
        return None
    zero = number(0.0, RealType())
    states = [_state(draft, use, f"{use.base}_state_{k + 1}", RealType(), zero) for k in range(n)]
    for row, state in enumerate(states):
        terms = [times(entry(a, row, k), other) for k, other in enumerate(states)]
        terms += [times(entry(b, row, k), value) for k, value in enumerate(inputs)]
        draft.next_values[state.name] = _sum([state, *terms])
    direct = inputs if _has_feedthrough(matrices[3], use.method) else []
    outputs = [
        _sum(
            [times(entry(c, row, k), state) for k, state in enumerate(states)]
            + [times(entry(d, row, k), value) for k, value in enumerate(direct)]
        )
        for row in range(p)
    ]
    if isinstance(use.type, ArrayType):
        return ArrayElements(type=use.type, values=tuple(outputs))
    return outputs[0]


def _is_discretized(draft: Draft, use: Application, report: Report) -> bool:
    """Whether coefficients can be computed, or are not needed as the period is not known; reports what is missing."""
    lacking = missing_package(use.method, is_statespace=use.operator == "statespace")
    if draft.sample is None or lacking is None:
        return True
    report.add(NotDiscretized(use.span, operator=use.operator, method=use.method, package=lacking))
    return False


def _remember(draft: Draft, use: Application, matrices: tuple[Expression, ...], names: list[str], *kinds: Type) -> None:
    kinds = kinds if len(kinds) == len(names) else kinds * len(names)
    draft.linear_operators.append(
        LinearOperator(
            matrices=matrices, method=use.method, coefficients=tuple(zip(names, kinds, strict=True)), span=use.span
        )
    )


def _sum(terms: list[Expression]) -> Expression:
    result = terms[0]
    for term in terms[1:]:
        result = plus(result, term)
    return result


def _is_zero(expression: Expression) -> bool:
    return isinstance(expression, LiteralValue) and expression.value == 0


def _without_leading_zeros(polynomial: Expression) -> Expression:
    """A polynomial in falling powers without leading zeros, except for a constant."""
    if isinstance(polynomial, LiteralValue) and isinstance(polynomial.value, tuple):
        inner = polynomial.type.element if isinstance(polynomial.type, ArrayType) else RealType()
        values = tuple(LiteralValue(type=inner, value=value) for value in polynomial.value)
        polynomial = ArrayElements(type=polynomial.type, span=polynomial.span, values=values)
    if not isinstance(polynomial, ArrayElements):
        return polynomial
    elements = list(polynomial.values)
    while len(elements) > 1 and _is_zero(elements[0]):
        del elements[0]
    kind = ArrayType(elements[0].type if elements else RealType(), len(elements))
    return ArrayElements(type=kind, span=polynomial.span, values=tuple(elements))


def _first(polynomial: Expression) -> Expression:
    return polynomial.values[0] if isinstance(polynomial, ArrayElements) else polynomial


def _length(polynomial: Expression) -> int:
    return (polynomial.type.size or 0) if isinstance(polynomial.type, ArrayType) else 0


def _shape(matrix: Expression) -> tuple[int, int] | None:
    rows = matrix.type
    if not (isinstance(rows, ArrayType) and isinstance(rows.element, ArrayType)):
        return None
    if isinstance(matrix, ArrayElements) and any(row.type != rows.element for row in matrix.values):
        return None
    size, width = rows.size, rows.element.size
    return (size, width) if size and width else None


def _misfit(shapes: list[tuple[int, int] | None]) -> str | None:
    for letter, shape in zip("ABCD", shapes, strict=True):
        if shape is None:
            return f"{letter} must be a list of rows of the same length"
    a, b, c, d = (shape or (0, 0) for shape in shapes)
    n, m, p = a[0], b[1], c[0]
    wanted = {"A": (a, (n, n)), "B": (b, (n, m)), "C": (c, (p, n)), "D": (d, (p, m))}
    for letter, (found, right) in wanted.items():
        if found != right:
            return f"{letter} is {found[0]}x{found[1]}, but should be {right[0]}x{right[1]}"
    return None


def _has_feedthrough(d: Expression, method: Method) -> bool:
    if method in ("tustin", "backward"):
        return True
    if isinstance(d, ArrayElements):
        return not all(isinstance(row, ArrayElements) and all(map(_is_zero, row.values)) for row in d.values)
    return True


_REALIZATIONS: dict[str, Callable[[Draft, Application, Report], Expression | None]] = {
    "pre": _pre,
    "delay": _delay,
    "integral": _integral,
    "derivative": _derivative,
    "lag": _lag,
    "transfer": _transfer,
    "statespace": _statespace,
}

METHODS: tuple[str, ...] = get_args(Method)
