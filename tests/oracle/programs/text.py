"""Programs as text for cspdiag.

A branch of the outermost parallel may be printed as a process of its own (`Program.boxed`); its channels become ports,
and arrows connect them. That changes how it is written, but not what it means.
"""

from __future__ import annotations

import re

from tests.oracle.programs.tree import (
    CONSTANTS,
    After,
    Alt,
    Array,
    Assign,
    Bin,
    Bool,
    Call,
    Catch,
    Channel,
    Comp,
    Convert,
    Enum,
    Event,
    Expr,
    Field,
    Guarded,
    If,
    If3,
    Index,
    Int,
    Interrupt,
    Law,
    Lit,
    Make,
    Mu,
    Now,
    Par,
    Port,
    Program,
    Raise,
    Read,
    Ready,
    Real,
    Ref,
    Replicated,
    Reset,
    Run,
    Seq,
    Skip,
    Stop,
    Struct,
    Target,
    Type,
    Un,
    Value,
    Variable,
    Wait,
    While,
    Write,
    walk,
)  # fmt: skip

CONSTANT = re.compile(r"\bk([0-9]+)\b")


def duration(nanoseconds: int) -> str:
    for unit, size in (("ms", 10**6), ("us", 1000)):
        if nanoseconds % size == 0:
            return f"{nanoseconds // size} {unit}"
    return f"{nanoseconds} ns"


def literal(value: Value, kind: Type) -> str:
    match kind:
        case Bool():
            return "true" if value else "false"
        case Enum():
            return str(value)
        case Real():
            return (
                repr(value).replace("+", "")
                if isinstance(value, float) and value >= 0
                else f"(-{-float(str(value))!r})"
            )
        case Int(name):
            assert isinstance(value, int)
            if value == -(2**63):  # its magnitude is not a number of its type
                return f"({literal(value + 1, kind)} - {literal(1, kind)})"
            size = duration(abs(value)) if name == "time" else str(abs(value))
            return size if value >= 0 else f"(-{size})"
        case Struct(name, fields):
            assert isinstance(value, tuple)
            inner = (f"{part} = {literal(v, t)}" for (part, t), v in zip(fields, value, strict=True))
            return f"{name}({', '.join(inner)})"
        case Array(element, _):
            assert isinstance(value, tuple)
            return "[" + ", ".join(literal(v, element) for v in value) + "]"


def shown(value: Value, kind: Type) -> object:
    """A value as in traces in JSON."""
    match kind:
        case Struct(_, fields):
            assert isinstance(value, tuple)
            return {name: shown(part, inner) for (name, inner), part in zip(fields, value, strict=True)}
        case Array(element, _):
            assert isinstance(value, tuple)
            return [shown(part, element) for part in value]
        case Enum():
            return str(value).partition(".")[2]
        case _:
            return value


def expression(expr: Expr) -> str:
    match expr:
        case Lit(value, kind, True):
            return f"k{CONSTANTS.index((value, kind))}"
        case Lit(value, kind):
            return literal(value, kind)
        case Ref(name):
            return name
        case Field(of, _, name):
            return f"{expression(of)}.{name}"
        case Index(of, at):
            return f"{expression(of)}[{expression(at)}]"
        case Bin(op, left, right):
            return f"({expression(left)} {op} {expression(right)})"
        case Un("not", of, _):
            return f"(not {expression(of)})"
        case Un("abs", of, _):
            return f"abs({expression(of)})"
        case Un(op, of, _):
            return f"({op}{expression(of)})"
        case Call(name, arguments, _):
            return f"{name}({', '.join(expression(argument) for argument in arguments)})"
        case Convert(of, kind):
            return f"{kind.name}({expression(of)})"
        case If3(condition, yes, no, _):
            return f"(if {expression(condition)} then {expression(yes)} else {expression(no)})"
        case Now():
            return "now"
        case Make(inner, Struct(name, fields)):
            named = (f"{part} = {expression(v)}" for (part, _), v in zip(fields, inner, strict=True))
            return f"{name}({', '.join(named)})"
        case Make(inner, _):
            return "[" + ", ".join(expression(part) for part in inner) + "]"


def condition(expr: Expr) -> str:
    """An expression without outer parentheses, where none are needed."""
    text = expression(expr)
    return text[1:-1] if isinstance(expr, Bin | If3) else text


def _time(time: int | Expr) -> str:
    return duration(time) if isinstance(time, int) else condition(time)


def _target(target: Target) -> str:
    return target.name + target.part


def _event(event: Event, ports: dict[str, str]) -> str:
    match event:
        case Read(channel, target):
            return f"{ports.get(channel + '?', channel)} ? {_target(target)}"
        case Write(channel, value):
            return f"{ports.get(channel + '!', channel)} ! {expression(value)}"
        case After(time, at):
            return f"{'at' if at else 'after'} {_time(time)}"
        case Ready(channel):
            return ports.get(channel + "?", channel)
        case Skip():
            return "skip"


def _guard(guard: Guarded, ports: dict[str, str]) -> str:
    when = f"when {condition(guard.when)} & " if guard.when is not None else ""
    return when + _event(guard.event, ports)


def composition(node: Comp, ports: dict[str, str]) -> str:
    """One composition, in parentheses wherever it may need them."""

    def inner(part: Comp) -> str:
        return composition(part, ports)

    match node:
        case Skip():
            return "skip"
        case Stop():
            return "stop"
        case Assign(target, value):
            return f"{_target(target)} := {condition(value)}"
        case Read() | Write():
            return _event(node, ports)
        case Wait(time, until):
            return f"wait {'until ' if until else ''}{_time(time)}"
        case Raise(name):
            return f"raise {name}"
        case Run(law):
            return law
        case Reset(law):
            return f"reset {law}"
        case Seq(steps):
            return "(" + " ; ".join(map(inner, steps)) + ")"
        case Par(branches, prioritized):
            return "(" + (" ||> " if prioritized else " || ").join(map(inner, branches)) + ")"
        case Guarded(_, body):
            return f"({_guard(node, ports)} -> {inner(body)})"
        case Alt(branches, prioritized):
            return "(" + (" []> " if prioritized else " [] ").join(map(inner, branches)) + ")"
        case Mu(body, None):
            return f"(mu {_grouped(body, ports)})"
        case Mu(body, until):
            assert until is not None
            return f"(mu {_grouped(body, ports)} until {condition(until)})"
        case While(test, body):
            return f"(while {condition(test)} do {_grouped(body, ports)})"
        case If(test, yes, None):
            return f"(if {condition(test)} then {inner(yes)})"
        case If(test, yes, no):
            assert no is not None
            return f"(if {condition(test)} then {inner(yes)} else {inner(no)})"
        case Catch(body, name, handler):
            return f"({_grouped(body, ports)} catch {name} -> {_grouped(handler, ports)})"
        case Interrupt(body, guard):
            return f"({_grouped(body, ports)} interrupt {_guard(guard, ports)} -> {_grouped(guard.body, ports)})"
        case Replicated(operator, variable, count, body):
            return f"({operator} {variable} < {count} : {inner(body)})"


def _grouped(node: Comp, ports: dict[str, str]) -> str:
    text = composition(node, ports)
    return text if text.startswith("(") else f"({text})"


def _law(law: Law) -> str:
    lines = [f"submodel {law.name.capitalize()}" + (f" wcet {duration(law.wcet)}" if law.wcet else "") + " {"]
    lines += [f"  in {name} : {kind.name}" for name, kind, _ in law.inputs]
    lines += [f"  out {name} : {kind.name}" for name, kind, _, _ in law.outputs]
    lines += [f"  state {name} : {kind.name} = {literal(initial, kind)}" for name, kind, initial, _ in law.states]
    lines += [f"  {name} = {condition(equation)}" for name, _, _, equation in law.outputs]
    lines += [f"  next {name} = {condition(equation)}" for name, _, _, equation in law.states]
    return "\n".join([*lines, "}"])


def _port(port: Port, name: str, kept_period: bool = True) -> str:
    period = f" @ {duration(port.period)}" if port.period and kept_period else ""
    period += f" offset {duration(port.offset)}" if period and port.offset else ""
    return (
        f"  {'in' if port.input else 'out'} {name} : {port.type.name}{period}{' immediate' if port.immediate else ''}"
    )


def _owned(law: Law, ports: dict[str, str]) -> list[str]:
    lines = [f"    {law.name} : {law.name.capitalize()}"]
    lines += [f"    {ports.get(source + '?', source)} -> {law.name}.{name}" for name, _, source in law.inputs]
    return lines + [f"    {law.name}.{name} -> {ports.get(sink + '!', sink)}" for name, _, sink, _ in law.outputs]


def _variable(variable: Variable) -> str:
    return f"    var {variable.name} : {variable.type.name} = {literal(variable.initial, variable.type)}"


def uses(node: Comp, laws: dict[str, Law]) -> set[str]:
    """The channels and ports of a composition, followed by `?` or `!`, including variables of laws."""
    found: set[str] = set()
    for part in walk(node):
        event = part.event if isinstance(part, Guarded) else part
        match event:
            case Read(channel, _) | Ready(channel):
                found.add(channel + "?")
            case Write(channel, _):
                found.add(channel + "!")
            case Run(name) if name in laws:
                found |= {source + "?" for _, _, source in laws[name].inputs}
                found |= {sink + "!" for _, _, sink, _ in laws[name].outputs}
    return found


def branches(program: Program) -> tuple[Comp, ...]:
    return program.body.parts if isinstance(program.body, Par) else (program.body,)


def text(program: Program, assertion: str = "") -> str:
    """The entire program with its environment; `assertion` is for example `deadlock free`."""
    return "\n".join([*definitions(program), *_environment(program)]) + (
        f"\nassert {program.name} {assertion}\n" if assertion else "\n"
    )


def definitions(program: Program) -> list[str]:
    lines = [f"enum {enum.name} {{ {', '.join(enum.literals)} }}" for enum in program.enums]
    for struct in program.structs:
        lines.append(f"struct {struct.name} {{ {' '.join(f'{name} : {kind.name}' for name, kind in struct.fields)} }}")
    lines += [f"exception {name}" for name in program.exceptions]
    lines += [_law(law) for law in program.laws]
    processes = process(program)
    if "constants" in program.tags or CONSTANT.search("\n".join([*lines, *processes])):
        lines += [f"const k{i} : {kind.name} = {literal(value, kind)}" for i, (value, kind) in enumerate(CONSTANTS)]
    return [*lines, *processes]


def process(program: Program) -> list[str]:
    """The outermost process, and its branches that are processes of their own."""
    laws = {law.name: law for law in program.laws}
    known = {channel.name for channel in program.channels} | {port.name for port in program.ports}
    lines: list[str] = []
    parts, used = branches(program), [uses(part, laws) for part in branches(program)]
    for number in sorted(program.boxed):
        lines += _box(program, number, parts[number], {end for end in used[number] if end[:-1] in known})
    lines.append(f"process {program.name} {{")
    lines += [_port(port, port.name) for port in program.ports]
    lines.append("  communication {")
    lines += [_variable(variable) for variable in program.variables if variable.owner not in program.boxed]
    for law in program.laws:
        if law.owner not in program.boxed:
            lines += _owned(law, {})
    for number in sorted(program.boxed):
        given = ", ".join(f"p{index} = k{index}" for index in _parameters(parts[number]))
        lines.append(f"    box{number} : {program.name}Box{number}{f'({given})' if given else ''}")
    for channel in program.channels:
        lines += _channel(channel, program.boxed, used)
    for port in program.ports:
        for number in sorted(program.boxed):
            if port.name + ("?" if port.input else "!") in used[number]:
                box = f"box{number}.{port.name}_{'r' if port.input else 'w'}"
                lines.append(f"    {port.name} -> {box}" if port.input else f"    {box} -> {port.name}")
    lines += ["  }", "  composition {"]
    names = [f"box{i}" if i in program.boxed else composition(part, {}) for i, part in enumerate(parts)]
    whole = (" ||> " if isinstance(program.body, Par) and program.body.prioritized else " || ").join(names)
    return [*lines, f"    {whole}", "  }", "}"]


def _kind(channel: Channel) -> str:
    return f"{channel.kind} {channel.size}" if channel.size else channel.kind


def _channel(channel: Channel, boxed: frozenset[int], used: list[set[str]]) -> list[str]:
    writers = [f"box{i}.{channel.name}_w" for i in sorted(boxed) if channel.name + "!" in used[i]]
    readers = [f"box{i}.{channel.name}_r" for i in sorted(boxed) if channel.name + "?" in used[i]]
    if not writers and not readers:
        return [f"    channel {channel.name} : {channel.type.name} {_kind(channel)}"]
    return [
        f"    {', '.join(writers)} -> {channel.name} : {channel.type.name} {_kind(channel)} -> {', '.join(readers)}"
    ]


def _box(program: Program, number: int, body: Comp, ends: set[str]) -> list[str]:
    kinds = {channel.name: channel.type for channel in program.channels}
    ports = {port.name: port for port in program.ports}
    names = {end: f"{end[:-1]}_{'r' if end.endswith('?') else 'w'}" for end in ends}
    given = ", ".join(f"p{index}: {CONSTANTS[int(index)][1].name}" for index in _parameters(body))
    lines = [f"process {program.name}Box{number}{f'({given})' if given else ''} {{"]
    for end in sorted(ends):
        port = ports.get(end[:-1]) or Port(end[:-1], end.endswith("?"), kinds[end[:-1]])
        lines.append(_port(port, names[end]))
    lines.append("  communication {")
    lines += [_variable(variable) for variable in program.variables if variable.owner == number]
    for law in program.laws:
        if law.owner == number:
            lines += _owned(law, names)
    inner = CONSTANT.sub(r"p\1", composition(body, names))
    return [*lines, "  }", "  composition {", f"    {inner}", "  }", "}"]


def _parameters(body: Comp) -> list[str]:
    """The constants of a composition, which become parameters of its process."""
    return sorted(set(CONSTANT.findall(composition(body, {}))))


def _environment(program: Program) -> list[str]:
    if not program.environment:
        return []
    lines: list[str] = []
    wires: list[str] = []
    for port in program.ports:
        model = f"Env_{port.name}"
        if port.input:
            value = literal(port.values[-1][1], port.type)
            for index in range(len(port.values) - 2, -1, -1):
                until, earlier = port.values[index + 1][0], port.values[index][1]
                value = f"if time < {duration(until)} then {literal(earlier, port.type)} else {value}"
            lines.append(f"submodel {model} {{ out k : {port.type.name}  k = {value} }}")
            wires.append(f"  env_{port.name}.k -> {port.name}")
        else:
            lines.append(f"submodel {model} {{ in k : {port.type.name} }}")
            wires.append(f"  {port.name} -> env_{port.name}.k")
    step = f" step {duration(program.step)}" if program.step else ""
    lines.append(f"environment Bench for {program.name}{step} {{")
    lines += [f"  env_{port.name} : Env_{port.name}" for port in program.ports]
    return [*lines, *wires, "}"]
