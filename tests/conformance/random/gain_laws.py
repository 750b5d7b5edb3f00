"""Random control laws with arguments, whose initial values, equations and operators with memory follow parameters."""

from __future__ import annotations

from dataclasses import dataclass, field
from random import Random

from tests.conformance.random.values import Scope

ARGUMENTS = ("double", "double", "int", "Gains", "bool", "Mode", "time", "Shape")
MEMORY = (
    "pre({x}, {start})", "delay({x}, {places}, {start})", "integral({x}, {start} * 1<s>) / 1<s>",
    "derivative({x}) * 1 ms", "lag({x}, {tau})", "quantize({x}, 0.125)", "deadzone({x}, {width})",
)  # fmt: skip
STATES = ("double", "double", "int", "double[2]", "bool", "Mode", "Gains", "der", "der")


@dataclass(frozen=True)
class Law:
    """A submodel with the inputs ``a : double`` and ``b : int``, and the outputs ``y : double`` and ``n : int``."""

    name: str
    arguments: tuple[tuple[str, str], ...]
    text: str


@dataclass
class _Equations:
    draw: Random
    scope: Scope
    """Arguments and parameters, which do not change within an instant."""
    lines: list[str] = field(default_factory=list)
    changing: list[tuple[str, str]] = field(default_factory=lambda: [("a", "double"), ("b", "int")])

    def value(self, kind: str, depth: int = 2) -> str:
        """An expression with inputs and states."""
        return self.scope.with_names(*self.changing).value(kind, depth)

    def state(self, number: int) -> None:
        """A state; what it becomes is an expression of what is declared when ``following`` is called."""
        kind = self.draw.choice(STATES)
        name, continuous = f"s{number}", kind == "der"
        kind = "double" if continuous else kind
        self.lines.append(f"  state {name} : {kind} = {self._initial(kind)}")
        self.changing.append((name, kind))
        if continuous:
            self.lines.append(f"  der {name} = (limit({self.value('double')}, -50, 50) - {name}) / {self._duration()}")
        else:
            self.lines.append(f"  next {name} = {self._following(name, kind)}")

    def _initial(self, kind: str) -> str:
        return Scope(self.draw, self.scope.names, True, literals=0.15).value(kind, self.draw.choice([0, 0, 1, 2]))

    def _duration(self) -> str:
        named = self.scope.named("time")
        return f"({named} + 2 ms)" if named and self.draw.random() < 0.7 else self.draw.choice(["4 ms", "700 us"])

    def _following(self, name: str, kind: str) -> str:
        draw = self.draw
        match kind:
            case "double":
                return f"limit({name} * 0.5 + {self.value('double')}, -100, 100)"
            case "int":
                return f"({name} + {self.value('int', 1)}) % 100"
            case "double[2]":
                return f"[{name}[1], limit({self.value('double')}, -9, 9)]"
            case "bool":
                return draw.choice([f"not {name}", self.value("bool")])
            case "Mode":
                return f"(if {self.value('bool')} then {name} else {self.value('Mode', 1)})"
            case _:
                return f"(if {self.value('bool', 1)} then {name} else {self.scope.value(kind, 1)})"

    def name_values(self, number: int) -> None:
        """A name for a value, of parameters and arguments alone or not."""
        kind, alone = self.draw.choice(["double", "double", "int", "bool"]), self.draw.random() < 0.5
        self.lines.append(f"  let m{number} = {self.scope.value(kind) if alone else self.value(kind)}")
        self.changing.append((f"m{number}", kind))

    def remember(self, number: int) -> None:
        """An operator with memory."""
        draw = self.draw
        form = draw.choice(MEMORY).format(
            x=self.value("double", 1),
            start=self._initial("double"),
            places=draw.randint(1, 3),
            tau=self._duration(),
            width=self.scope.value("double", 0),
        )
        self.lines.append(f"  let o{number} = limit({form}, -1000, 1000)")
        self.changing.append((f"o{number}", "double"))

    def contain(self, number: int, inner: Law) -> None:
        """A law within."""
        name = f"inner{number}"
        self.lines += [f"  {name} : {inner.name}{given(self.draw, inner, self.scope, 1)}"]
        self.lines += [f"  {name}.a = {self.value('double', 1)}", f"  {name}.b = {self.value('int', 1)}"]
        self.changing += [(f"{name}.y", "double"), (f"{name}.n", "int")]


def given(draw: Random, law: Law, scope: Scope, depth: int = 2) -> str:
    """The arguments of an instance of a law, some by their defaults."""
    chosen = [(name, kind) for name, kind in law.arguments if draw.random() < 0.8]
    plain = Scope(draw, scope.names, literals=0.25)
    text = ", ".join(f"{name} = {plain.value(kind, draw.randint(0, depth))}" for name, kind in chosen)
    return f"({text})" if text else ""


def law(draw: Random, number: int, names: tuple[tuple[str, str], ...], faulting: float, within: list[Law]) -> Law:
    """A law that may use the parameters of the program by their names, and contain others."""
    kinds = draw.sample(ARGUMENTS, draw.randint(0, 4))
    arguments = tuple((f"g{position}", kind) for position, kind in enumerate(kinds))
    plain = Scope(draw, names, literals=0.3)
    head = ", ".join(f"{name}: {kind} = {plain.value(kind, 1)}" for name, kind in arguments)
    made = _Equations(draw, Scope(draw, (*names, *arguments), True, faulting))
    steps = [made.state] * draw.randint(1, 3) + [made.name_values] * draw.randint(0, 3)
    steps += [made.remember] * draw.randint(0, 2)
    draw.shuffle(steps)
    for position, step in enumerate(steps):
        step(position)
    if within and draw.random() < 0.3:
        made.contain(len(steps), draw.choice(within))
    made.lines.append(f"  y = limit({made.value('double', 3)}, -1e6, 1e6)")
    made.lines.append(f"  n = {made.value('int', 2)} % 1000")
    clause = draw.choice(["", "", " method = euler", " step 300 us", " method = backward", " method = zoh"])
    name = f"Law{number}"
    ports = ["  in  a : double", "  in  b : int", "  out y : double", "  out n : int"]
    text = "\n".join([f"submodel {name}{f'({head})' if head else ''}{clause} {{", *ports, *made.lines, "}", ""])
    return Law(name, arguments, text)
