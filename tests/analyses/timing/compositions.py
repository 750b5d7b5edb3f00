"""Random programs of sampled loops in every form that the timing analysis knows, with execution times."""

from __future__ import annotations

import random
from dataclasses import dataclass, field

from tests.analyses.timing.programs import law

FORMS = ("one law", "laws in sequence", "laws in parallel", "two periods", "a partner", "a delay")


@dataclass
class Composed:
    """A program, its ports, and the period of each law in nanoseconds by path."""

    source: random.Random
    laws: list[str] = field(default_factory=list)
    inputs: list[tuple[str, int]] = field(default_factory=list)
    outputs: list[tuple[str, int]] = field(default_factory=list)
    parts: list[str] = field(default_factory=list)
    runs: list[str] = field(default_factory=list)
    periods: dict[str, int] = field(default_factory=dict)

    def law(self, period: int, *, sampled: bool = True, written: bool = True) -> str:
        """One more law; ``sampled`` from and ``written`` to ports of its own."""
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
        """Two laws of which the second goes on with what the first has computed."""
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
            case _:
                name = self.law(period)
                self.inputs.append((f"z{name}", period))
                self.parts.append(f"var v{name} : double = 0")
                self.runs.append(f"(mu (z{name} ? v{name} ; wait {self.source.randint(50, 200)} us ; {name}))")

    def text(self) -> str:
        """The program, its loops in a random order, with or without priorities."""
        self.source.shuffle(self.runs)
        composition = self.source.choice([" || ", " ||> "]).join(self.runs)
        ports = "".join(f"  in {name} : double @ {period} ms\n" for name, period in self.inputs)
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
