"""Looks for processes that end with the last value of a control law on a sampled output.

For each point of the composition the ports are known whose last value may come from a submodel in a loop that has
ended; a point that cannot be reached has no such set (None). Each operator maps the set before it to the set after it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TypeAlias, assert_never

from cspdiag.base import Report
from cspdiag.model.program import PortSymbol, Program
from cspdiag.model.types import (
    ArrayType,
    BoolType,
    EnumType,
    IntType,
    RealType,
    StructType,
    TextType,
    TimeType,
    Type,
    UnknownType,
)
from cspdiag.network.diagnostics.samples.release import OutputNotReleased
from cspdiag.syntax import ast
from cspdiag.syntax.walk import declared_in, nodes

Driven: TypeAlias = "Mapping[PortSymbol, ast.Run] | None"
"""The sampled outputs that were last written by a submodel in a loop, with where it was run."""

_NOTHING: Mapping[PortSymbol, ast.Run] = {}

_SHOWN = 4
"""Elements of an array that are written out in what is suggested."""


def check_release(program: Program, report: Report) -> None:
    """Warn of every sampled output that a process leaves as a loop of a submodel wrote it last."""
    for definition in program.definitions.values():
        if isinstance(definition, ast.ProcessDefinition) and definition.composition is not None:
            _check_process(program, definition, definition.composition, report)


def _check_process(
    program: Program, definition: ast.ProcessDefinition, composition: ast.Composition, report: Report
) -> None:
    outputs = dict(_outputs_of_instances(program, definition))
    if not outputs:
        return
    left = _Release(program, outputs).after(composition, _NOTHING, loops=False)
    for port, run in (left or _NOTHING).items():
        report.add(
            OutputNotReleased(
                run.span,
                process=definition.name.text,
                port=port.name,
                instance=run.instance.name.text,
                release=_release_value(port.type),
                port_span=port.port.span,
            )
        )


def _outputs_of_instances(
    program: Program, definition: ast.ProcessDefinition
) -> Iterator[tuple[ast.Instance, tuple[PortSymbol, ...]]]:
    """The sampled outputs of a process that each of its instances writes."""
    found: dict[ast.Instance, tuple[PortSymbol, ...]] = {}
    for declaration in declared_in(definition):
        if not isinstance(declaration, ast.Connection):
            continue
        sinks = [port for sink in declaration.sinks if (port := _sampled_output(program, sink)) is not None]
        for source in declaration.sources:
            instance = program.bindings.get(source)
            if isinstance(instance, ast.Instance) and sinks:
                found[instance] = (*found.get(instance, ()), *sinks)
    yield from found.items()


def _sampled_output(program: Program, part: ast.Node) -> PortSymbol | None:
    symbol = program.bindings.get(part)
    if (
        isinstance(symbol, PortSymbol)
        and symbol.declaration.direction == "out"
        and symbol.declaration.sampling is not None
    ):
        return symbol
    return None


def _release_value(type_: Type) -> str:
    """Zero, false, the first literal of an enumeration, and the same in each field and element."""
    match type_:
        case BoolType():
            return "false"
        case RealType(unit=unit) if str(unit) != "1":
            return f"0<{unit}>"
        case IntType() | RealType() | TimeType():
            return "0"
        case EnumType(name=name, literals=(first, *_)):
            return f"{name}.{first}"
        case StructType(name=name, fields=fields):
            return f"{name}({', '.join(f'{field} = {_release_value(inner)}' for field, inner in fields)})"
        case ArrayType(element=element, size=size):
            value = _release_value(element)
            shown = (value, "…", value) if size is None or size > _SHOWN else (value,) * size
            return f"[{', '.join(shown)}]"
        case TextType() | EnumType():
            raise AssertionError(f"no port has the type {type_}")
        case UnknownType():
            return "…"
        case _:
            assert_never(type_)


def _either(*states: Driven) -> Driven:
    """What may be driven when one of several paths was taken."""
    reached = [state for state in states if state is not None]
    return {port: run for state in reached for port, run in state.items()} if reached else None


class _Release:
    def __init__(self, program: Program, outputs: Mapping[ast.Instance, tuple[PortSymbol, ...]]) -> None:
        self.program = program
        self.outputs = outputs

    def after(self, part: ast.Composition, before: Mapping[PortSymbol, ast.Run], *, loops: bool) -> Driven:
        """What is driven after ``part``; ``loops`` says whether it is in a loop that can end."""
        match part:
            case ast.Run():
                return self._after_run(part, before, loops)
            case ast.Write():
                return self._after_write(part.channel, before)
            case ast.Stop() | ast.Raise():
                return None
            case ast.Skip() | ast.Wait() | ast.Reset() | ast.Read() | ast.Assign():
                return before
            case ast.Sequence():
                return self._after_sequence(part, before, loops)
            case ast.Parallel():
                return self._after_parallel(part, before, loops)
            case ast.Alternative():
                return _either(*(self.after(branch, before, loops=loops) for branch in part.branches))
            case ast.Guarded():
                event = part.guard.event
                if isinstance(event, ast.OutputGuard):
                    before = self._after_write(event.channel, before)
                return self.after(part.process, before, loops=loops)
            case ast.Mu():
                return None if part.until is None else self.after(part.process, before, loops=True)
            case ast.While():
                return _either(before, self.after(part.process, before, loops=True))
            case ast.If():
                otherwise = before if part.otherwise is None else self.after(part.otherwise, before, loops=loops)
                return _either(self.after(part.then, before, loops=loops), otherwise)
            case ast.Catch() | ast.Interrupt():
                abandoned = {**before, **dict(self._driven_anywhere(part.process))}
                return _either(
                    self.after(part.process, before, loops=loops),
                    self.after(part.handler, abandoned, loops=loops),
                )
            case ast.Replicated() | ast.Labelled():
                return self.after(part.process, before, loops=loops)
            case _:
                assert_never(part)

    def _after_run(self, run: ast.Run, before: Mapping[PortSymbol, ast.Run], loops: bool) -> Driven:
        written = self._written_by(run)
        state = {port: at for port, at in before.items() if port not in written}
        return {**state, **dict.fromkeys(written, run)} if loops and self._is_submodel(run) else state

    def _after_write(
        self, channel: ast.Reference, before: Mapping[PortSymbol, ast.Run]
    ) -> Mapping[PortSymbol, ast.Run]:
        written = _sampled_output(self.program, channel)
        return {port: at for port, at in before.items() if port is not written}

    def _after_sequence(self, part: ast.Sequence, before: Mapping[PortSymbol, ast.Run], loops: bool) -> Driven:
        state: Driven = before
        for step in part.processes:
            if state is None:
                return None
            state = self.after(step, state, loops=loops)
        return state

    def _after_parallel(self, part: ast.Parallel, before: Mapping[PortSymbol, ast.Run], loops: bool) -> Driven:
        states = [self.after(branch, before, loops=loops) for branch in part.processes]
        reached = [state for state in states if state is not None]
        if len(reached) < len(states):
            return None
        released = {port for port in before if any(port not in state for state in reached)}
        driven = {port: run for state in reached for port, run in state.items() if before.get(port) is not run}
        return {**{port: run for port, run in before.items() if port not in released}, **driven}

    def _driven_anywhere(self, part: ast.Composition) -> Iterator[tuple[PortSymbol, ast.Run]]:
        for found in nodes(part):
            if isinstance(found, ast.Run) and self._is_submodel(found):
                yield from ((port, found) for port in self._written_by(found))

    def _written_by(self, run: ast.Run) -> tuple[PortSymbol, ...]:
        instance = self.program.bindings.get(run.instance)
        return self.outputs.get(instance, ()) if isinstance(instance, ast.Instance) else ()

    def _is_submodel(self, run: ast.Run) -> bool:
        instance = self.program.bindings.get(run.instance)
        if not isinstance(instance, ast.Instance):
            return False
        return isinstance(self.program.definitions.get(instance.definition.text), ast.SubmodelDefinition)
