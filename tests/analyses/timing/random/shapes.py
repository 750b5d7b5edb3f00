"""Random programs of every shape that a composition may have: loops one after another, waits and events anywhere,
modes, handlers, partners.

Most are put together from forms that keep up with their samples, with an occasional form that does not. Nothing here
knows what the analysis can prove.
"""

from __future__ import annotations

import random
import re
from dataclasses import dataclass, field

LENGTHS = ("50 us", "300 us", "1 ms", "3 ms", "7 ms", "30 ms")
OVER_AT_ONCE = ("0 ms", "1 ms - 1 ms", "min(0 ms, 3 ms)")


@dataclass
class Unit:
    """A part of a program with its own ports: a process, or a branch of the process around it."""

    name: str
    declared: list[str] = field(default_factory=list)
    inputs: dict[str, int | None] = field(default_factory=dict)
    """Inputs with their periods in milliseconds; None for an event."""
    reads: list[str] = field(default_factory=list)
    writes: list[str] = field(default_factory=list)
    text: str = "skip"


def _used(channels: list[str], unit: Unit) -> list[str]:
    """Ends of some of the channels that the unit uses."""
    lines = "\n".join([unit.text, *unit.declared])
    return [name for name in channels if re.search(rf"\b{name}\b", lines)]


class Shapes:
    """A random program; ``text`` is the entire program, with an environment whose inputs change randomly."""

    def __init__(self, seed: int) -> None:
        self.source = random.Random(seed)
        self.laws: list[str] = []
        self.processes: list[str] = []
        self.channels: list[str] = []
        self._names = 0
        self.wildness = self.source.choice([0, 0, 0.05, 0.15, 0.4])
        """How often something appears where it may do harm."""
        self.heaviness = self.source.choice([0.05, 0.2, 0.5, 1.5])
        self.text = self._program()

    def _name(self, letter: str) -> str:
        self._names += 1
        return f"{letter}{self._names}"

    def _wild(self) -> bool:
        return self.source.random() < self.wildness

    # What a unit has.

    def _law(self, unit: Unit, sampled: str | None) -> str:
        """One more law, of a port or of a variable."""
        name = self._name("l")
        micros = max(1, round(self.heaviness * self.source.choice([10, 50, 200, 900])))
        self.laws.append(f"submodel L{name} wcet {micros} us {{ in x : double  out y : double  y = 2 * x }}")
        unit.declared += [f"{name} : L{name}", f"{name}.y -> _"]
        if sampled is None:
            variable = self._variable(unit)
            unit.declared.append(f"{variable} -> {name}.x")
        else:
            unit.declared.append(f"{sampled} -> {name}.x")
        return name

    def _variable(self, unit: Unit) -> str:
        name = self._name("v")
        unit.declared.append(f"var {name} : double = 0")
        return name

    def _port(self, unit: Unit, period: int | None) -> str:
        name = self._name("x" if period else "e")
        unit.inputs[name] = period
        return name

    def length(self, unit: Unit, lengths: tuple[str, ...] = LENGTHS) -> str:
        """A duration; occasionally zero or negative."""
        kind = self.source.random()
        if kind < 0.06:
            return self.source.choice(OVER_AT_ONCE)
        if kind < 0.12:
            name = self._name("t")
            unit.declared.append(f"var {name} : time = {self.source.choice(['0 ms', '-2 ms', '1 ms'])}")
            return name
        return self.source.choice(lengths)

    def _condition(self, unit: Unit) -> str:
        """A condition on a value that comes from outside."""
        if not unit.declared or self.source.random() < 0.05:
            return self.source.choice(["true", "false"])
        variables = [line.split()[1] for line in unit.declared if line.startswith("var ") and " : time " not in line]
        if not variables:
            return "true"
        return f"{self.source.choice(variables)} > {self.source.randint(0, 9)}"

    # What happens after a sample, or after something else.

    def _sampled(self, unit: Unit, period: int) -> str:
        """Take one sample of a period, and do something with it."""
        port = self._port(unit, period)
        match self.source.randint(0, 3):
            case 0:
                return f"({port} ? {self._variable(unit)})"
            case 1:
                return f"({port} ? {self._variable(unit)} ; {self._law(unit, None)})"
            case _:
                return self._law(unit, port)

    def _work(self, unit: Unit, period: int, depth: int) -> str:
        """Something that may be done with a sample, or besides it."""
        if self._wild():
            return self._harm(unit, period, depth)
        if depth == 0:
            return self._law(unit, None)
        below = depth - 1
        match self.source.randint(0, 12):
            case 0 | 1:
                return self._law(unit, None)
            case 11:
                return self._counting(unit)
            case 12:
                return self._failing(unit, period)
            case 2:
                return f"({self._work(unit, period, below)} ; {self._work(unit, period, below)})"
            case 3:
                return f"({self._work(unit, period, below)} || {self._work(unit, period, below)})"
            case 4:
                return (
                    f"(if {self._condition(unit)} then {self._work(unit, period, below)} else "
                    f"{self._work(unit, period, below)})"
                )
            case 5:
                return f"wait {self.length(unit, LENGTHS[:3])}"
            case 6:
                return self._sampled(unit, period)
            case 7:
                return (
                    f"(({self._work(unit, period, below)} ; (if {self._condition(unit)} then raise Oops)) catch Oops "
                    f"-> {self._work(unit, period, below)})"
                )
            case 8 if self.channels_of(unit):
                return self.channels_of(unit)
            case 9:
                variable = self._variable(unit)
                return f"{variable} := {variable} + 1"
            case _:
                return "skip"

    def _count(self, unit: Unit) -> str:
        name = self._name("i")
        unit.declared.append(f"var {name} : int = {self.source.choice([0, 0, 1, 5])}")
        return name

    def _counting(self, unit: Unit) -> str:
        """A loop of computing that ends."""
        i, k = self._count(unit), self.source.randint(1, 6)
        forms = [
            f"({i} := 0 ; mu {i} := {i} + 1 until {i} > {k})",
            f"({i} := 0 ; mu {i} := {i} + 1 until {i} == {k})",
            f"({i} := {k} ; while {i} > 0 do {i} := {i} - 1)",
            f"(while {i} < {k} do (if {self._condition(unit)} then {i} := {i} + 2 else {i} := {i} + 1))",
            f"(mu {i} := {i} + 1 until {i} >= {k} or {self._condition(unit)})",
            f"({i} := 1 ; while {i} < {10 * k} and not ({i} == {k}) do {i} := 2 * {i})",
        ]
        return self.source.choice(forms)

    def _failing(self, unit: Unit, period: int) -> str:
        """A fault after or before a sample, in some iteration, and iterations that wait where it is caught."""
        i, k = self._count(unit), self.source.randint(1, 6)
        parts = [self._sampled(unit, period), f"{i} := {i} + 1 ; {i} := {i} + 0 / ({i} - {k})"]
        if self.source.random() < 0.2:
            parts.reverse()
        turns = f"seq {self._name('r')} < {self.source.randint(1, 4)} : wait {self.length(unit, LENGTHS[:3])}"
        return f"(({' ; '.join(parts)}) catch Fault -> ({turns}))"

    def _computing(self, unit: Unit) -> str:
        """A loop of computing that may or may not end."""
        i, j, k = self._count(unit), self._count(unit), self.source.randint(1, 6)
        add, other = self.source.choice("+-"), self.source.choice("+-")
        steps = [
            f"{i} := 1 - {i}",
            f"{i} := {i} {add} {self.source.randint(0, 2)}",
            f"(if {self._condition(unit)} then {i} := {i} {add} 1 else {i} := {i} {other} 1)",
            f"({i} := {i} {add} 1 ; {j} := {j} {other} 1)",
            f"(({i} := {i} {add} 1 ; (if {self._condition(unit)} then raise Oops)) catch Oops -> {i} := {i} {other} 1)",
            f"({i} := {i} {add} 1 catch Fault -> {j} := 0)",
            f"(mu {i} := {i} {add} 1 until {i} > {k} or {j} > 2)",
        ]
        step = self.source.choice(steps)
        compared = self.source.choice([">", "<", ">=", "<=", "==", "!="])
        bound = self.source.choice([str(k), j, f"{j} + {k}"])
        first = self.source.choice(["", f"{i} := 0 ; ", f"{j} := {k} ; "])
        if self.source.random() < 0.3:
            return f"({first}while {i} {compared} {bound} do {step})"
        return f"({first}mu {step} until {i} {compared} {bound})"

    def channels_of(self, unit: Unit) -> str:
        """A communication of the unit, if it has one."""
        ends = [f"{c} ! {self._variable(unit)}" for c in unit.writes] + [
            f"{c} ? {self._variable(unit)}" for c in unit.reads
        ]
        return self.source.choice(ends) if ends else ""

    def _harm(self, unit: Unit, period: int, depth: int) -> str:
        """Something that may well make a unit late for its next sample."""
        below = max(0, depth - 1)
        match self.source.randint(0, 10):
            case 0:
                return f"wait {self.length(unit)}"
            case 10:
                return self._computing(unit)
            case 1:
                return f"({self._port(unit, None)} ? {self._variable(unit)})"
            case 2:
                return f"(seq i < {self.source.randint(2, 4)} : {self._sampled(unit, period)})"
            case 3:
                return (
                    f"((mu {self._round(unit, period, below)}) interrupt {self._guard(unit, period)} -> "
                    f"{self._work(unit, period, below)})"
                )
            case 4:
                return f"(mu {self._round(unit, period, below)} until {self._condition(unit)})"
            case 5:
                return self._sampled(unit, self.source.choice([1, 2, 4, 5, 10]))
            case 6:
                return (
                    f"({self._work(unit, period, below)} || (mu {self._round(unit, period, below)} until "
                    f"{self._condition(unit)}))"
                )
            case 7:
                return f"({self._guard(unit, period)} -> {self._work(unit, period, below)})"
            case 8 if self.channels_of(unit):
                return f"(mu {self.channels_of(unit)} until {self._condition(unit)})"
            case _:
                return (
                    f"(when {self._condition(unit)} & {self._guard(unit, period)} -> skip {self._or()} "
                    f"{self._guard(unit, period)} -> skip)"
                )

    def _or(self) -> str:
        return self.source.choice(["[]", "[]>"])

    def _guard(self, unit: Unit, period: int) -> str:
        match self.source.randint(0, 4):
            case 0:
                return f"{self._port(unit, period)} ? {self._variable(unit)}"
            case 1 | 2:
                return f"{self._port(unit, None)} ? {self._variable(unit)}"
            case 3:
                return f"after {self.length(unit)}"
            case _ if unit.reads:
                return f"{self.source.choice(unit.reads)} ? {self._variable(unit)}"
            case _:
                return "skip"

    def _branch(self, unit: Unit, period: int, depth: int) -> str:
        """A branch of an alternative next to the sample."""
        body = self.source.choice(
            [lambda: "skip", lambda: self._law(unit, None), lambda: self._work(unit, period, depth)]
        )()
        match self.source.randint(0, 4):
            case 0 | 1:
                guard = f"{self._port(unit, None)} ? {self._variable(unit)}"
            case 2:
                guard = f"{self._port(unit, 2 * period)} ? {self._variable(unit)}"
            case 3 if unit.reads:
                guard = f"{self.source.choice(unit.reads)} ? {self._variable(unit)}"
            case _:
                guard = f"after {self.length(unit)}"
        if self._wild():
            guard = f"when {self._condition(unit)} & {guard}"
        return f"{guard} -> {body}"

    def _round(self, unit: Unit, period: int, depth: int) -> str:
        """An iteration of a loop that takes a sample."""
        match self.source.randint(0, 5):
            case 0 | 1:
                return f"({self._sampled(unit, period)} ; {self._work(unit, period, depth)})"
            case 2:
                port = self._port(unit, period)
                own = self._law(unit, port)
                body = own if self.source.random() < 0.6 else f"({own} ; {self._work(unit, period, depth)})"
                branches = [f"{port} -> {body}", self._branch(unit, period, depth)]
                self.source.shuffle(branches)
                return f"({f' {self._or()} '.join(branches)})"
            case 3:
                return f"({self._sampled(unit, period)} || {self._sampled(unit, period)})"
            case 4 if self._wild():
                one = self._sampled(unit, period)
                return (
                    f"({one} ; {one})"
                    if self.source.random() < 0.5
                    else f"({one} ; {self._sampled(unit, period)} ; {one})"
                )
            case _:
                return f"({self._sampled(unit, period)})"

    # Loops, modes and what comes between them.

    def _behaviour(self, unit: Unit, period: int, depth: int) -> str:
        parts = []
        if self.source.random() < 0.2:
            parts.append(self._before(unit, period))
        if self.source.random() < 0.1:
            parts.append(self._counting(unit) if self.source.random() < 0.5 else self._computing(unit))
        for _ in range(self.source.choice([0, 0, 0, 1, 1, 2])):
            parts.append(self._mode(unit, period, depth))
            if self._wild():
                parts.append(self._harm(unit, period, depth))
        if len(parts) > 1 and self.source.random() < 0.3:
            return f"(mu ({' ; '.join(parts)}))"
        parts.append(f"(mu {self._round(unit, period, depth)})")
        return parts[0] if len(parts) == 1 else f"({' ; '.join(parts)})"

    def _before(self, unit: Unit, period: int) -> str:
        """What comes before a first sample does no harm."""
        match self.source.randint(0, 2):
            case 0:
                return f"wait {self.length(unit)}"
            case 1:
                return f"{self._port(unit, None)} ? {self._variable(unit)}"
            case _:
                return self._law(unit, None)

    def _mode(self, unit: Unit, period: int, depth: int) -> str:
        """A loop that ends, often in a process of its own."""
        inner = Unit(self._name("P"), reads=unit.reads, writes=unit.writes)
        loop = self._round(inner, period, depth)
        match self.source.randint(0, 3):
            case 0:
                inner.text = f"(mu {loop}) interrupt {self._port(inner, None)} ? {self._variable(inner)} -> skip"
            case 1:
                inner.text = f"(mu {loop}) interrupt after {self.length(inner, LENGTHS[2:])} -> skip"
            case 2:
                inner.text = f"mu {loop} until {self._condition(inner)}"
            case _:
                count = self._variable(inner)
                inner.text = f"mu ({loop} ; {count} := {count} + 1) until {count} > 3"
        if self.source.random() < 0.75:
            return self._process(inner, unit)
        unit.declared += inner.declared
        unit.inputs |= inner.inputs
        return f"({inner.text})"

    def _process(self, inner: Unit, around: Unit) -> str:
        """Turn a unit into a process of the one around it."""
        reads, writes = _used(inner.reads, inner), _used(inner.writes, inner)
        ports = [f"in {name} : double" for name in [*inner.inputs, *reads]]
        ports += [f"out {name} : double" for name in writes]
        lines = "  ".join(inner.declared)
        self.processes.append(
            f"process {inner.name} {{ {'  '.join(ports)} communication {{ {lines} }} composition {{ {inner.text} }} }}"
        )
        name = inner.name.lower()
        around.declared.append(f"{name} : {inner.name}")
        around.declared += [f"{port} -> {name}.{port}" for port in [*inner.inputs, *reads]]
        around.declared += [f"{name}.{port} -> {port}" for port in writes]
        around.inputs |= inner.inputs
        return name

    def _helper(self, unit: Unit) -> str:
        """A loop without samples."""
        parts = [self.channels_of(unit)] if self.channels_of(unit) else [f"wait {self.length(unit)}"]
        if self.source.random() < 0.5:
            parts.append(self._law(unit, None))
        if self._wild():
            parts.append(self._harm(unit, self.source.choice([1, 2, 5]), 1))
        if self.source.random() < 0.3:
            event = f"{self._port(unit, None)} ? {self._variable(unit)}"
            first = self.channels_of(unit).split(" ; ")[0]
            if "?" in first:
                return f"(mu ({first} -> {self._law(unit, None)} {self._or()} {event} -> skip))"
            if self.source.random() < 0.3:
                parts.insert(0, event)
        self.source.shuffle(parts)
        return f"(mu ({' ; '.join(parts)}))"

    def _program(self) -> str:
        main = Unit("Main")
        count = self.source.choice([1, 1, 2, 2, 3])
        units = [Unit(self._name("U")) for _ in range(count)]
        helpers = set()
        if count > 1 and self.source.random() < 0.5:
            for _ in range(self.source.choice([1, 1, 2])):
                writer, reader = self.source.sample(range(count), 2)
                channel = self._name("c")
                kind = self.source.choice(["", "", "", "overwrite 1", "buffer 1", "buffer 3"])
                main.declared.append(f"channel {channel} : double {kind}")
                units[writer].writes.append(channel)
                units[reader].reads.append(channel)
                if self.source.random() < 0.4:
                    helpers.add(self.source.choice([writer, reader]))
        runs = []
        for k, unit in enumerate(units):
            period = self.source.choice([1, 2, 4, 5])
            depth = self.source.choice([0, 1, 1, 2])
            saved = len(self.processes)
            for _ in range(20):
                del self.processes[saved:]
                unit.declared, unit.inputs = [], {}
                unit.text = self._helper(unit) if k in helpers else self._behaviour(unit, period, depth)
                ends = [*unit.writes, *unit.reads]
                if _used(ends, unit) == ends:
                    break
            if self.source.random() < 0.6:
                runs.append(self._process(unit, main))
            else:
                main.declared += unit.declared
                main.inputs |= unit.inputs
                runs.append(unit.text)
        if count == 3 and self.source.random() < 0.3:
            tail = self.source.choice([" || ", " ||> "]).join(runs[1:])
            runs = [runs[0], f"({tail})"]
        main.text = self.source.choice([" || ", " ||> "]).join(runs)
        if count > 1 and self.source.random() < 0.05:
            main.text = (
                f"({main.text}) interrupt {self._port(main, None)} ? {self._variable(main)} -> (mu "
                f"{self._round(main, 2, 0)})"
            )
        if not main.inputs:
            main.text = f"({main.text}) || (mu {self._sampled(main, 2)})"
        return self._written(main)

    def _written(self, main: Unit) -> str:
        ports = [f"in {name} : double" + (f" @ {period} ms" if period else "") for name, period in main.inputs.items()]
        sources = []
        wires = []
        for k, name in enumerate(main.inputs):
            start, rate = self.source.randint(1, 65000), self.source.choice([1, 2, 3, 8, 40])
            sources.append(
                f"state s{k} : int = {start}  next s{k} = (s{k} * 75 + 74) % 65537  state n{k} : int = 0  "
                f"next n{k} = if s{k} % {rate} == 0 then (n{k} + 1 + s{k} % 3) % 10 else n{k}  {name} = double(n{k})"
            )
            wires.append(f"source.{name} -> {name}")
        lines = "\n    ".join(main.declared)
        body = "\n".join([*self.laws, *self.processes])
        return (
            f"exception Oops\n{body}\nprocess Main {{\n  {'  '.join(ports)}\n  communication {{\n    {lines}\n  }}\n"
            f"  composition {{ {main.text} }}\n}}\n"
            f"submodel Source {{ out {', '.join(main.inputs)} : double\n{chr(10).join(sources)} }}\n"
            f"environment Bench for Main step {self.source.choice(['1 ms', '1 ms', '500 us', '2 ms'])} {{ source : "
            f"Source {'  '.join(wires)} }}\n"
        )
