"""Whether what elements do depends on values that they get from others."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from cspdiag.model.program import BuiltinSymbol, EndLabelSymbol, PortSymbol, Program, Symbol
from cspdiag.network.elaborate.fewer.varying import Varying
from cspdiag.syntax import ast
from cspdiag.syntax.walk import names, nodes


def are_independent_of_values(program: Program, varying: Varying) -> bool:
    """Whether which steps a process takes depends on no value that varies or was communicated.

    Such values may be communicated and assigned, but not be compared, counted with, waited for or used as an index, and
    nothing may be caught or interrupted. Processes in another language are taken to depend on what they get.
    """
    processes = [item for item in program.definitions.values() if isinstance(item, ast.ProcessDefinition)]
    if any(process.composition is None for process in processes):
        return False
    parts = [*nodes(*processes)]
    if any(isinstance(part, ast.Catch | ast.Interrupt) for part in parts):
        return False
    given = _given(program, varying, parts)
    passed_on = {*names(values_passed_on(parts))}
    looked_at = (program.bindings.get(part) for part in parts if isinstance(part, ast.Name) and part not in passed_on)
    return not any(symbol in given or _is_from_outside(symbol) for symbol in looked_at)


def _is_from_outside(symbol: Symbol | None) -> bool:
    """Whether a name is that of a port, or the present instant."""
    if isinstance(symbol, BuiltinSymbol):
        return symbol.name == "time"
    return isinstance(symbol, PortSymbol | EndLabelSymbol)


def only_values_vary(program: Program, varying: Varying, definition: ast.ProcessDefinition) -> bool:
    """Whether nothing varies in a process but values that it communicates and assigns."""
    parts = [*nodes(definition)]
    passed_on = {*names(values_passed_on(parts))}
    return not any(
        isinstance(part, ast.Name) and part not in passed_on and program.bindings.get(part) in varying.symbols
        for part in parts
    )


def _given(program: Program, varying: Varying, parts: list[ast.Node]) -> set[ast.Node]:
    """The variables with values that vary or were communicated."""
    given: set[ast.Node] = set()
    assigned: list[tuple[ast.Node, ast.Expression]] = []
    for part in parts:
        match part:
            case ast.Read(target=target) | ast.InputGuard(target=target):
                given.update(_variable(program, target))
            case ast.Assign(target=target, value=value):
                assigned += ((variable, value) for variable in _variable(program, target))
            case _:  # Nothing else gives a variable a value while the process runs.
                pass
    before = -1
    while before != len(given):
        before = len(given)
        for variable, value in assigned:
            found = {program.bindings.get(name) for name in names((value,))}
            if not found.isdisjoint(given) or not found.isdisjoint(varying.symbols):
                given.add(variable)
    return given


def _variable(program: Program, target: ast.Reference) -> Iterator[ast.Node]:
    symbol = program.bindings.get(target)
    if isinstance(symbol, ast.Node):
        yield symbol


def values_passed_on(parts: Iterable[ast.Node]) -> Iterator[ast.Expression]:
    """The values that nodes communicate or assign without looking at them; an index looks at its value."""
    for part in parts:
        match part:
            case ast.Write(value=value) | ast.Assign(value=value) | ast.OutputGuard(value=value):
                if not any(isinstance(inner, ast.Index) for inner in nodes(value)):
                    yield value
            case _:  # No other node passes values on.
                pass
