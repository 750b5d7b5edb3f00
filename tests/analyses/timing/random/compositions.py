"""Random programs of sampled loops in every form that the timing analysis knows, with execution times."""

from __future__ import annotations

import random
from dataclasses import dataclass, field

from tests.analyses.timing.programs import law

FORMS = (
    "one law", "laws in sequence", "laws in parallel", "two periods", "a partner", "a delay",
    "work on arrival", "a server", "a shared listener", "an event",
)  # fmt: skip


@dataclass
class Composed:
    """A program, its ports, and the period of each law in nanoseconds by path."""

    source: random.Random
    laws: list[str] = field(default_factory=list)
    inputs: list[tuple[str, int]] = field(default_factory=list)
    events: list[str] = field(default_factory=list)
    outputs: list[tuple[str, int]] = field(default_factory=list)
    parts: list[str] = field(default_factory=list)
    runs: list[str] = field(default_factory=list)
    periods: dict[str, int] = field(default_factory=dict)

    def law(self, period: int, *, sampled: bool = True, written: bool = True) -> str:
        """One more law; ``sampled`` and ``written`` are ports of its own."""
        number = len(self.laws)
        self.laws.append(law(f"Law{number}", f"{self.source.randint(20, 250)} us"))
        self.parts.append(f"law{number} : Law{number}")
        self.periods[f"Main.law{number}"] = period * 1_000_000
        if sampled:
            self.inputs.append((f"x{number}", period))
            self.parts.append(f"x{number} -> law{number}.x")
        if written:
            self.outputs.append((f"y{number}", period))
            self.parts.append(f"law{number}.y -> y{number}")
        return f"law{number}"

    def passed_on(self, period: int) -> tuple[str, str]:
        """Two laws, the second of which continues with the result of the first."""
        first, second = self.law(period, written=False), self.law(period, sampled=False)
        self.parts.append(f"{first}.y -> {second}.x")
        return first, second

    def add(self, form: str) -> None:
        """One more loop, or two that meet."""
        period = self.source.choice([1, 2, 4, 5])
        match form:
            case "one law":
                self.runs.append(f"(mu {self.law(period)})")
            case "laws in sequence":
                self.runs.append(f"(mu ({' ; '.join(self.passed_on(period))}))")
            case "laws in parallel":
                self.runs.append(f"(mu ({self.law(period)} || {self.law(period)}))")
            case "two periods":
                fast, slow = self.law(period), self.law(2 * period)
                self.runs.append(f"(mu (x{fast[3:]} -> {fast} [] x{slow[3:]} -> {slow}))")
            case "a partner":
                self.runs += [f"(mu {name})" for name in self.passed_on(period)]
            case "work on arrival":
                self._work_on_arrival(period)
            case "a server":
                self._server()
            case "a shared listener":
                self._listener()
            case "an event":
                name = self.law(1, sampled=False)
                self.events.append(f"e{name}")
                self.parts += [f"var v{name} : double = 0", f"v{name} -> {name}.x"]
                self.runs.append(f"(mu (e{name} ? v{name} -> {name}))")
            case _:
                name = self.law(period)
                self.inputs.append((f"z{name}", period))
                self.parts.append(f"var v{name} : double = 0")
                self.runs.append(f"(mu (z{name} ? v{name} ; wait {self.source.randint(50, 200)} us ; {name}))")

    def _work_on_arrival(self, period: int) -> None:
        """A loop that passes on the values that another one computes with, in addition to its own samples."""
        first, then = self.law(period, written=False), self.law(period, sampled=False)
        own = self.law(self.source.choice([1, 2, 4, 5]))
        kind = self.source.choice(["", "overwrite 1", "overwrite 2", "buffer 1", "buffer 2"])
        operator = self.source.choice(["[]", "[]>"])
        self.parts += [f"var a{first} : double = 0", f"var b{first} : double = 0", f"{first}.y -> a{first}"]
        self.parts += [f"b{first} -> {then}.x", f"channel c{first} : double {kind}"]
        guards = [f"c{first} ? b{first} -> {then}", f"x{own[3:]} -> {own}"]
        self.source.shuffle(guards)
        self.runs += [f"(mu ({first} ; c{first} ! a{first}))", f"(mu ({f' {operator} '.join(guards)}))"]

    def _server(self) -> None:
        """Two loops that are clients of the same server."""
        serving = self.law(1, sampled=False, written=False)
        self.parts += [f"var q{serving} : double = 0", f"var r{serving} : double = 0"]
        self.parts += [f"q{serving} -> {serving}.x", f"{serving}.y -> r{serving}"]
        served = []
        for _ in range(2):
            asks = self.law(self.source.choice([2, 4, 5]), sampled=False)
            period = self.periods[f"Main.{asks}"] // 1_000_000
            self.inputs.append((f"z{asks}", period))
            self.parts += [f"var v{asks} : double = 0", f"var w{asks} : double = 0", f"w{asks} -> {asks}.x"]
            self.parts += [f"channel ask{asks} : double", f"channel answer{asks} : double"]
            self.runs.append(f"(mu (z{asks} ? v{asks} ; ask{asks} ! v{asks} ; answer{asks} ? w{asks} ; {asks}))")
            served.append(f"ask{asks} ? q{serving} -> ({serving} ; answer{asks} ! r{serving})")
        self.runs.append(f"(mu ({' [] '.join(served)}))")

    def _listener(self) -> None:
        """Two loops that write to a third one, which has no samples of its own."""
        listening = self.law(1, sampled=False, written=False)
        kind = self.source.choice(["any", "any", "overwrite 1"])
        writers = [self.law(self.source.choice([1, 2, 4, 5]), written=False) for _ in range(2 if kind == "any" else 1)]
        self.parts += [f"var n{listening} : double = 0", f"n{listening} -> {listening}.x", f"{listening}.y -> _"]
        self.parts.append(f"channel d{listening} : double {kind}")
        for writer in writers:
            self.parts += [f"var m{writer} : double = 0", f"{writer}.y -> m{writer}"]
            self.runs.append(f"(mu ({writer} ; d{listening} ! m{writer}))")
        self.runs.append(f"(mu (d{listening} ? n{listening} ; {listening}))")

    def _composition(self, runs: list[str]) -> str:
        """Some of the loops together within the others, or all in parallel."""
        operator = self.source.choice([" || ", " ||> "])
        if len(runs) < 3 or self.source.random() < 0.6:
            return operator.join(runs)
        cut = self.source.randint(1, len(runs) - 1)
        return operator.join(
            part if len(own) == 1 else f"({part})"
            for own in (runs[:cut], runs[cut:])
            for part in [self._composition(own)]
        )

    def text(self) -> str:
        """The program, its loops in a random order, with or without priorities."""
        self.source.shuffle(self.runs)
        composition = self._composition(self.runs)
        ports = "".join(f"  in {name} : double @ {period} ms\n" for name, period in self.inputs)
        ports += "".join(f"  in {name} : double\n" for name in self.events)
        ports += "".join(f"  out {name} : double @ {period} ms\n" for name, period in self.outputs)
        diagram = "\n".join(f"    {part}" for part in self.parts)
        return (
            f"{''.join(self.laws)}process Main {{\n{ports}  communication {{\n{diagram}\n  }}\n"
            f"  composition {{ {composition} }}\n}}\n"
        )


def composed(seed: int) -> Composed:
    """The program of a seed."""
    program = Composed(random.Random(seed))
    for _ in range(program.source.randint(2, 4)):
        program.add(program.source.choice(FORMS))
    return program
