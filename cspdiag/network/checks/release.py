"""Finds processes that may end with the last value of a control law on a sampled output.

At each point of the composition it is known where each port may have been written last.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
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
from cspdiag.network.flow.code import Call, Instruction, Join
from cspdiag.network.flow.dataflow import solve
from cspdiag.network.flow.effects import writes
from cspdiag.network.ir.actions import PortEnd, Repeat, RunInstance, WhileLoop
from cspdiag.network.shapes import Shape
from cspdiag.syntax import ast
from cspdiag.syntax.walk import declared_in

Written: TypeAlias = Mapping[PortSymbol, frozenset[tuple[int, bool]]]
"""The instructions that may have written an output last; True if it was a submodel in a loop."""

_SHOWN = 4
"""The number of elements of an array that are written out in a suggestion."""


def check_release(program: Program, shapes: Iterable[Shape], report: Report) -> None:
    """Warn of every sampled output that keeps the last value of a submodel in a loop when its process ends."""
    for shape in shapes:
        if shape.body is not None and isinstance(shape.definition, ast.ProcessDefinition):
            _check_process(program, shape, shape.definition, report)


def _check_process(program: Program, shape: Shape, definition: ast.ProcessDefinition, report: Report) -> None:
    outputs = dict(_outputs_of_instances(program, definition))
    for port, run in _driven_at_end(shape, outputs) if outputs else ():
        report.add(
            OutputNotReleased(
                run.span,
                process=definition.name.text,
                port=port.name,
                instance=shape.instances[run.instance].declaration.name.text,
                release=_release_value(port.type),
                port_span=port.port.span,
            )
        )


def _outputs_of_instances(
    program: Program, definition: ast.ProcessDefinition
) -> Iterator[tuple[ast.Instance, tuple[PortSymbol, ...]]]:
    """The sampled outputs of a process that each of its instances writes."""
    found: dict[ast.Instance, tuple[PortSymbol, ...]] = {}
    if not any(ports.sampling is not None and ports.direction == "out" for ports in definition.ports):
        return
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
    """Zero, false, the first literal of an enumeration, and the same for each field and element."""
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


def _driven_at_end(
    shape: Shape, outputs: Mapping[ast.Instance, tuple[PortSymbol, ...]]
) -> Iterator[tuple[PortSymbol, RunInstance]]:
    """The outputs that a submodel in a loop may have written last, with the run of that submodel."""
    code = shape.flow
    looping = {i for action, inside in code.decisions if isinstance(action, Repeat | WhileLoop) for i in inside}
    parallels = {i.fork: range(i.fork, index) for index, i in enumerate(code.instructions) if isinstance(i, Join)}
    abandoned: dict[int, Written] = {}
    """By ``Abandon``, what submodels write that may be abandoned there, in a loop or not."""

    def written_by(instruction: Instruction) -> tuple[PortSymbol, ...]:
        if isinstance(instruction, Call):
            return outputs.get(shape.instances[instruction.step.instance].declaration, ())
        return tuple(shape.ports[place.port].symbol for place in writes(instruction) if isinstance(place, PortEnd))

    def is_law(instruction: Instruction) -> bool:
        return isinstance(instruction, Call) and shape.instances[instruction.step.instance].shape.is_submodel

    def after(index: int, instruction: Instruction, before: Written) -> Written:
        ports, write = written_by(instruction), frozenset({(index, index in looping and is_law(instruction))})
        found = {**before, **dict.fromkeys(ports, write)} if ports else before
        return _any_of([found, abandoned[index]]) if index in abandoned else found

    def merged(instruction: Instruction, states: list[Written]) -> Written:
        """What was written before a parallel stays where no branch has written since."""
        found = _any_of(states)
        if not isinstance(instruction, Join):
            return found
        inside = parallels[instruction.fork]
        return {
            port: frozenset(w for w in last if w[0] in inside or all(w in state.get(port, ()) for state in states))
            for port, last in found.items()
        }

    for index, (instruction, target) in enumerate(zip(code.instructions, code.abandoned, strict=True)):
        if target is not None:
            write = frozenset({(index, True)})
            own: Written = dict.fromkeys(written_by(instruction), write) if is_law(instruction) else {}
            abandoned[target] = _any_of([abandoned.get(target, {}), abandoned.get(index, {}), own])
    nothing: Written = {}
    last = solve(code, nothing, after, merged)[-1] or nothing
    for port in dict.fromkeys(port for ports in outputs.values() for port in ports):
        driving = code.instructions[max((index for index, is_driven in last.get(port, ()) if is_driven), default=-1)]
        if isinstance(driving, Call):
            yield port, driving.step


def _any_of(states: Sequence[Written]) -> Written:
    ports = dict.fromkeys(port for state in states for port in state)
    return {port: frozenset().union(*(state.get(port, frozenset()) for state in states)) for port in ports}
