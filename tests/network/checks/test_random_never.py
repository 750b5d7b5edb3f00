"""Nothing that happens in a run is reported never to happen.

Random parts with replicators, in several instances of one process; each part is on a line of its own and writes the
number of that line. ``python -m tests.network.checks.test_random_never NUMBER`` tries more programs.
"""

from __future__ import annotations

import random
import re
import sys
from contextlib import suppress

from cspdiag import pipeline
from cspdiag.base.span import SourceFile
from cspdiag.semantics.execute import execute
from cspdiag.semantics.scheduler import Scheduler

COMMUNICATIONS = 1000
"""A run with this many communications is long enough."""

PROCESS = """exception X
exception Y
process Part(n: int, d: time) {{
  in  x : int @ 2 ms
  out o : int
  out late : int
  communication {{ var v : int = 0  var m : int = 1 }}
  composition {{
    {composition}
  }}
}}
process Main {{
  in  x : int @ 2 ms
  out o : int
  out late : int
  communication {{
    part[i < {parts}] : Part(n = {n}, d = {d})
    for i < {parts} {{ x -> broadcast -> part[i].x }}
    for i < {parts} {{ part[i].o -> any -> o }}
    for i < {parts} {{ part[i].late -> any -> late }}
  }}
  composition {{ par i < {parts} : part[i] }}
}}
submodel Source {{
  out y : int
  y = 1
}}
environment Bench for Main {{
  source : Source
  source.y -> x
  o -> _
  late -> _
}}
"""


class _EnoughError(Exception):
    pass


class _Text:
    """Generates compositions; ``variables`` are the replicators around them."""

    def __init__(self, chance: random.Random) -> None:
        self.chance = chance
        self.variables: list[str] = []

    def number(self) -> str:
        return self.chance.choice(["n", "0", "1", "2", *self.variables, *self.variables])

    def condition(self) -> str:
        return f"{self.number()} {self.chance.choice(['==', '!=', '<', '>='])} {self.number()}"

    def duration(self) -> str:
        return self.chance.choice(["d", "1 ms", "2 ms", f"{self.number()} * 1 ms", f"({self.number()} + 1) * 1 ms"])

    def guard(self) -> str:
        when = f"when {self.condition()} & " if self.chance.random() < 0.3 else ""
        return when + self.chance.choice(["skip", f"after {self.duration()}", f"after {self.duration()}", "x ? v"])

    def part(self, depth: int) -> str:
        chance = self.chance
        match chance.randrange(9 if depth else 2):
            case 0:
                return chance.choice([f"wait {self.duration()}", f"late ! {self.number()}", "v := m", "x ? v"])
            case 1:
                return f"if {self.condition()} then {chance.choice(['raise X', 'raise Y', 'stop', 'v := 2'])}"
            case 2 | 3 | 4:
                operator = chance.choice([" [] ", " []> "])
                guards = dict.fromkeys(self.guard() for _ in range(chance.randint(1, 3)))
                once = [one for one in guards if "x ?" not in one] + [one for one in guards if "x ?" in one][:1]
                return "(" + operator.join(f"{guard} -> \n({self.marked(depth - 1)})" for guard in once) + ")"
            case 5:
                return f"(({self.marked(depth - 1)}) catch {chance.choice(['X', 'Y'])} -> \n({self.marked(depth - 1)}))"
            case 6:
                return f"(({self.marked(depth - 1)}) interrupt {self.guard()} -> \n({self.marked(depth - 1)}))"
            case 7:
                times = chance.choice(["", f" until {self.condition()}"])
                first = chance.choice(["wait 1 ms", f"wait {self.duration()}"])
                return f"((mu ({first} ;\n{self.marked(depth - 1)}){times}) interrupt after 7 ms -> skip)"
            case _:
                variable, count = f"k{depth}", chance.choice(["1", "2", "3", "n"])
                self.variables.append(variable)
                inside = self.marked(depth - 1)
                self.variables.pop()
                is_sequence = chance.random() < 0.7 or re.search(r"x \?|v :=", inside)
                return f"({'seq' if is_sequence else 'par'} {variable} < {count} : \n({inside}))"

    def marked(self, depth: int) -> str:
        steps = [self.part(depth) for _ in range(self.chance.randint(1, 3))]
        return " ;\n".join(f"o ! MARK ; {step}" for step in steps)


def program(seed: int) -> str:
    """A program in which each part writes its line."""
    chance = random.Random(seed)
    parts = chance.randint(1, 3)
    text = PROCESS.format(
        composition=_Text(chance).marked(3),
        parts=parts,
        n=chance.choice(["0", "1", "2", "i", "2 - i"]),
        d=chance.choice(["0 ms", "1 ms", "3 ms", "i * 1 ms"]),
    )
    lines = text.splitlines(keepends=True)
    return "".join(line.replace("MARK", str(number)) for number, line in enumerate(lines, 1))


def reported_and_run(seed: int) -> tuple[set[int], set[int]] | None:
    """The lines that are reported never to run, and those that do; None if a program is refused for another reason."""
    text = program(seed)
    source = SourceFile(name="never.csp", text=text)
    built = pipeline.build(source, lambda _: source)
    reported = set()
    for found in built.checked.report.diagnostics:
        line, _ = source.position(found.span.start)
        if found.code in {"W0613", "W0615"}:
            # What runs when a branch is chosen begins on the line below its guard.
            line += 1
        if found.code in {"W0611", "W0613", "W0615"}:
            reported.add(line)
    if built.network is None:
        return None
    run: set[int] = set()

    def look(world: Scheduler) -> None:
        last = world.trace[-1]
        if last.channel == "Main.o":
            assert isinstance(last.value, int)
            run.add(last.value)
        if len(world.trace) > COMMUNICATIONS:
            raise _EnoughError

    # A loop whose delays are zero in some instance would continue forever.
    with suppress(_EnoughError):
        execute(built.network, until=40_000_000, look=look)
    return reported, run


def hunt(seeds: range) -> tuple[int, int, list[int]]:
    """How many programs ran, how many parts were reported never to run, and the seeds of false reports."""
    answers = {seed: answer for seed in seeds if (answer := reported_and_run(seed)) is not None}
    wrong = [seed for seed, (reported, run) in answers.items() if reported & run]
    return len(answers), sum(len(reported) for reported, _ in answers.values()), wrong


def test_what_is_reported_as_impossible_never_happens() -> None:
    ran, reported, wrong = hunt(range(50))
    assert wrong == []
    assert ran > 30
    assert reported > 10


if __name__ == "__main__":
    print(hunt(range(int(sys.argv[1]))))
