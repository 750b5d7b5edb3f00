"""Random chains of sampled loops whose hops end exactly at each other's ticks: most times are multiples of a quarter of
a millisecond.
"""

from __future__ import annotations

import random

QUARTER = 250
"""Microseconds."""
CHANNELS = ("", "overwrite 1", "overwrite 2", "buffer 1", "buffer 2")


class Aged:
    """A chain of one to three loops from the input ``x0`` to the output ``y``. Each loop has samples of its own, lets
    time pass or computes, and passes on what it has received; some pass it on only under a condition, in every second
    sample, or for a while. ``inputs`` are the names of the sampled inputs.
    """

    def __init__(self, seed: int) -> None:
        self.source = random.Random(f"aged {seed}")
        self.laws: list[str] = []
        self.diagram: list[str] = []
        self.spent = 0
        """The maximum time in microseconds from the sample of the last loop to its write, if nothing else runs."""
        self.threads: list[list[tuple[str, str]]] = []
        """The branches of each thread, as guard and body."""
        self.periods = [self.source.choice([1, 2, 3, 4, 5, 6]) for _ in range(self.source.choice([1, 1, 2, 2, 3]))]
        self.inputs = [f"x{k}" for k in range(len(self.periods))]
        self.text = self._program()

    def _variable(self, name: str) -> str:
        self.diagram.append(f"var {name} : double = 0")
        return name

    def _program(self) -> str:
        source = self.source
        value = self._variable("v0")
        twice = "x0 ? again" if source.random() < 0.1 else ""
        if twice:
            self._variable("again")
        self.threads.append([("x0 ? v0", twice)])
        for k in range(len(self.periods)):
            if k:
                value = self._received(k, value)
            value = self._work(k, value)
        output = self.periods[-1] if source.random() < 0.4 else source.choice([1, 2, 3, 4, 5, 6])
        written = f"offset {self.spent % (1000 * output)} us"
        latch = source.choice(["", "", "immediate", f"offset {self._quarters(output)} us", *[written] * 2])
        conditional = source.random() < 0.1
        self._then(f"(if {value} < 0.07 then y ! {value} else skip)" if conditional else f"y ! {value}")
        runs = [self._thread(branches) for branches in self.threads]
        source.shuffle(runs)
        ports = " ".join(f"in x{k} : double @ {period} ms" for k, period in enumerate(self.periods))
        return (
            f"{''.join(self.laws)}process Main {{ {ports} out y : double @ {output} ms {latch}\n"
            f"communication {{ {' '.join(self.diagram)} }}\n"
            f"composition {{ {source.choice([' || ', ' ||> ']).join(runs)} }} }}\n"
        )

    def _then(self, step: str) -> None:
        """Add a step to the loop that was begun last."""
        guard, body = self.threads[-1][-1]
        self.threads[-1][-1] = guard, f"{body} ; {step}" if body else step

    def _quarters(self, period: int) -> int:
        return QUARTER * self.source.randrange(0, 4 * period)

    def _work(self, k: int, value: str) -> str:
        """Add what the loop does with a value; returns the name of the result."""
        source = self.source
        self.spent = 0
        longest = self.periods[k] if len(self.periods) == 1 else max(1, self.periods[k] // 2)
        if source.random() < 0.4:
            self.spent = max(QUARTER, self._quarters(longest))
            self._then(f"wait {self.spent} us")
        if source.random() < 0.5:
            micros = self._quarters(longest) if source.random() < 0.8 else source.randint(1, 300)
            self.spent += micros
            self.laws.append(f"submodel Law{k} wcet {micros} us {{ in p : double  out y : double  y = p }}\n")
            self.diagram += [f"law{k} : Law{k}", f"{value} -> law{k}.p", f"law{k}.y -> {self._result(k)}"]
            self._then(f"law{k}")
            value = f"r{k}"
        if source.random() < 0.2:
            self._then(f"{self._variable(f'h{k}')} := {self._variable(f'l{k}')} ; l{k} := {value}")
            value = f"h{k}"
        if source.random() < 0.2:
            kept = self._variable(f"k{k}")
            condition = f"{self._variable(f'n{k}')} {source.choice(['< 2', '> 3', '> -1'])}"
            then = f"{kept} := {value}"
            otherwise = source.choice(["skip", f"{kept} := {value}", "skip"])
            self._then(
                f"n{k} := n{k} + 1 ; (if n{k} > {source.randint(4, 30)} then n{k} := 0 else skip) ;"
                f" (if {condition} then {then} else {otherwise})"
            )
            value = kept
        return value

    def _result(self, k: int) -> str:
        return self._variable(f"r{k}")

    def _received(self, k: int, value: str) -> str:
        """Add how the next loop gets a value: in a variable of its own thread, or over a channel."""
        source = self.source
        self._variable(f"u{k}")
        kind = source.choice(["variable", "sample", *CHANNELS])
        if kind == "variable":
            self.threads[-1].append((f"x{k} ? u{k}", ""))
            return value
        taken = self._variable(f"a{k}")
        channel = source.choice(["", "buffer 1"]) if kind == "sample" else kind
        self.diagram.append(f"channel c{k} : double {channel}")
        self._then(f"c{k} ! {value}")
        if kind == "sample":
            self.periods[k] = self.periods[k - 1]
            self.threads.append([(f"x{k} ? u{k}", f"c{k} ? a{k}")])
        else:
            self.threads.append([(f"c{k} ? a{k}", "skip"), (f"x{k} ? u{k}", "")])
        return taken

    def _thread(self, branches: list[tuple[str, str]]) -> str:
        if len(branches) == 1:
            return f"(mu ({' ; '.join(part for part in branches[0] if part)}))"
        shown = [f"{guard} -> ({body or 'skip'})" for guard, body in branches]
        return f"(mu ({self.source.choice([' [] ', ' []> ']).join(shown)}))"
