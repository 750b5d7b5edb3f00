"""Reaction times and data ages: programs whose samples carry their instants run on a processor that takes time, and
show how old their outputs are.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import dataclass, field
from math import gcd

import pytest

from cspdiag.analyses.timing.report.timing import timing_report
from cspdiag.analyses.timing.result import TimingReport
from cspdiag.network.ir.network import Network
from tests.analyses.timing.processor import on_processor, run, wcets, with_bench
from tests.analyses.timing.programs import MS, US, network_of
from tests.analyses.timing.seen import seen_in
from tests.support.thorough import usual_or_thorough

LONGEST = 10**15


@pytest.fixture(autouse=True)
def processor() -> Iterator[None]:
    with on_processor():
        yield


@dataclass
class Chained:
    """A chain of loops from the input ``x0`` to the output ``y``; each has samples of its own and passes on what it
    received.
    """

    source: random.Random
    laws: list[str] = field(default_factory=list)
    diagram: list[str] = field(default_factory=list)
    threads: list[list[str]] = field(default_factory=list)
    periods: list[int] = field(default_factory=list)

    def law(self) -> str:
        name = f"law{len(self.laws)}"
        inputs = "p, x" if self.laws else "p"
        wcet = self.source.randint(20, 300)
        self.laws.append(
            f"submodel {name.capitalize()} wcet {wcet} us {{ in {inputs} : double out y : double y = p }}\n"
        )
        self.diagram.append(f"{name} : {name.capitalize()}")
        if self.laws[1:]:
            self.diagram.append(f"x{len(self.laws) - 1} -> {name}.x")
        return name

    def build(self) -> str:
        count = self.source.randint(2, 3)
        self.periods = [self.source.choice([1, 2, 3, 4, 5, 10]) for _ in range(count)]
        value = f"{self.law()}.y"
        self.diagram.append("x0 -> law0.p")
        self.threads.append(["x0 -> law0"])
        for k in range(1, count):
            name = self.law()
            if self.source.random() < 0.3:
                self.diagram += [f"var v{k} : double = 0", f"{value} -> v{k}", f"v{k} -> {name}.p"]
                self.threads[-1].append(f"x{k} -> {name}")
            else:
                self.taken_up(k, name, value)
            value = f"{name}.y"
        self.diagram.append(f"{value} -> y")
        return self.text(count)

    def taken_up(self, k: int, name: str, value: str) -> None:
        """A loop in a thread of its own, which takes what arrives between its samples, perhaps by way of a process that
        passes it on.
        """
        kind = self.source.choice(["", "overwrite 1", "overwrite 3", "buffer 1", "buffer 3"])
        self.diagram += [f"var a{k} : double = 0", f"var b{k} : double = 0", f"channel c{k} : double {kind}"]
        self.diagram += [f"{value} -> a{k}", f"b{k} -> {name}.p"]
        self.threads[-1] = [f"{part} ; c{k} ! a{k}" if part.endswith(value[:-2]) else part for part in self.threads[-1]]
        taken = f"c{k} ? b{k}"
        if self.source.random() < 0.4:
            self.diagram += [f"channel d{k} : double", f"var r{k} : double = 0", f"var s{k} : double = 0"]
            relays = [
                f"c{k} ? r{k} ; d{k} ! r{k}",
                f"d{k} ! r{k} ; c{k} ? r{k}",
                f"c{k} ? r{k} ; d{k} ! s{k} ; s{k} := r{k}",
            ]
            if not kind.startswith("overwrite"):
                self.threads.append([f"#{self.source.choice(relays)}"])
                taken = f"d{k} ? b{k}"
        self.threads.append([f"{taken} -> skip", f"x{k} -> {name}"])

    def offset(self, period: int) -> str:
        """The offset of the output, in half of the programs."""
        source = random.Random(repr(self.laws))
        return f"offset {source.randrange(0, 1000 * period, 250)} us" if source.random() < 0.5 else ""

    def text(self, count: int) -> str:
        runs = []
        for thread in self.threads:
            self.source.shuffle(thread)
            parts = [
                f"{guard} -> ({rest})" if " ; " in rest else part
                for part in thread
                for guard, _, rest in [part.partition(" -> ")]
            ]
            runs.append(
                f"mu ({self.source.choice([' [] ', ' []> ']).join(parts)})"
                if thread[0][0] != "#"
                else f"mu ({thread[0][1:]})"
            )
        self.source.shuffle(runs)
        ports = "".join(f"in x{k} : double @ {period} ms\n" for k, period in enumerate(self.periods))
        latch = "immediate" if self.source.random() < 0.3 else self.offset(self.periods[count - 1])
        used = "\n".join(self.diagram)
        return (
            f"{''.join(self.laws)}process Main {{ {ports} out y : double @ {self.periods[count - 1]} ms {latch}\n"
            f"communication {{ {used} }}\ncomposition {{ {self.source.choice([' || ', ' ||> ']).join(runs)} }} }}\n"
        )


def seen(network: Network, times: dict[str, int], source: random.Random | None, until: int) -> tuple[int, int]:
    """The longest time from a change of the sampled value to an output that depends on it, and the age of the oldest
    sample behind an output.
    """
    found = run(network, lambda path: times[path] if source is None else source.randint(1, times[path]), until)
    age, reaction, _ = seen_in(found, "Main.y")
    return reaction, age


def bounds(report: TimingReport) -> tuple[int, int]:
    ours = [chain for chain in report.chains if (chain.source, chain.sink) == ("x0", "y")]
    assert ours, report.chains
    # Where there is no bound, nothing is compared.
    reactions = [LONGEST if chain.reaction is None else chain.reaction for chain in ours]
    return max(reactions), max(LONGEST if chain.age is None else chain.age for chain in ours)


def test_no_change_is_seen_later_and_no_output_is_older_than_was_bounded() -> None:
    compared = close = 0
    for seed in range(usual_or_thorough(20, 200)):
        chained = Chained(random.Random(seed))
        text = chained.build()
        network = with_bench(text, [f"x{k}" for k in range(len(chained.periods))], ["y"], "1 ms")
        report = timing_report(network)
        if not report.is_schedulable:
            continue
        reaction, age = bounds(report)
        times = wcets(network)
        for source in (None, chained.source):
            found = seen(network, times, source, 120 * MS)
            assert found[0] <= reaction, text
            assert found[1] <= age, text
        compared += 1
        close += reaction - found[0] <= max(chained.periods) * MS
    assert compared >= usual_or_thorough(16, 160)
    assert close >= 0.8 * compared


def two_laws(order: str) -> Network:
    return network_of(
        f"""
        submodel First wcet 100 us {{ in x : double  out y : double  y = x }}
        submodel Second wcet 200 us {{ in p, x : double  out y : double  y = p }}
        process Main {{
          in  x0, x1 : double @ 2 ms
          out y      : double @ 2 ms
          communication {{
            first : First
            second : Second
            var passed : double = 0
            x0 -> first.x
            first.y -> passed
            passed -> second.p
            x1 -> second.x
            second.y -> y
          }}
          composition {{ {order} }}
        }}
        """
    )


def test_a_value_computed_after_its_use_is_used_a_sample_later() -> None:
    """In one order the value passes through in one sample, in the other it waits until the next."""
    straight = bounds(timing_report(two_laws("mu (first ; second)")))
    assert straight == (4 * MS, 2 * MS)
    late = bounds(timing_report(two_laws("mu (second ; first)")))
    assert late == (6 * MS + 300 * US, 4 * MS + 300 * US)
    either = bounds(timing_report(two_laws("mu (x0 -> first [] x1 -> second)")))
    assert either == late


def test_a_value_passes_through_assignments() -> None:
    text = """
        submodel Law wcet 100 us { in p : double  out y : double  y = p }
        process Main {
          in  x : double @ 2 ms
          out y : double @ 2 ms
          communication {
            law : Law
            var taken  : double = 0
            var halved : double = 0
            var result : double = 0
            halved -> law.p
            law.y -> result
          }
          composition { mu (x ? taken ; halved := taken / 2 ; law ; y ! result + 1) }
        }
        """
    assert bounds_of(text, "x") == (4 * MS, 2 * MS)


def bounds_of(text: str, name: str) -> tuple[int, int]:
    (chain,) = timing_report(network_of(text)).chains
    assert (chain.source, chain.sink) == (name, "y")
    assert chain.reaction is not None
    assert chain.age is not None
    return chain.reaction, chain.age


@pytest.mark.parametrize(
    ("loop", "output", "offset", "reaction", "age"),
    [
        *[(1, 1, 0, 2, 1), (1, 5, 0, 6, 1), (5, 1, 0, 6, 1), (2, 5, 0, 7, 2), (5, 2, 0, 7, 2), (4, 6, 0, 10, 4)],
        *[(2, 2, 1, 3, 1), (1, 5, 2, 6, 1), (4, 6, 1, 9, 3), (6, 4, 3, 9, 3), (5, 5, 4, 9, 4)],
    ],
)
def test_an_output_of_another_rate_has_the_last_value_written(
    loop: int, output: int, offset: int, reaction: int, age: int
) -> None:
    """A sample is written at once and output at the next tick, unless a later one is written before."""
    text = f"""
        submodel Law wcet 1 us {{ in p : double  out y : double  y = p }}
        process Main {{
          in  x : double @ {loop} ms
          out y : double @ {output} ms offset {offset} ms
          communication {{
            law : Law
            var taken  : double = 0
            var result : double = 0
            taken -> law.p
            law.y -> result
          }}
          composition {{ mu (x ? taken ; law ; y ! result) }}
        }}
        """
    assert bounds_of(text, "x") == (reaction * MS, age * MS)
    (row,) = timing_report(network_of(text)).loops
    assert row.latency == ((offset % gcd(loop, output) or gcd(loop, output)) * MS, age * MS)
    network = with_bench(text, ["x"], ["y"], "1 ms")
    found = seen(network, wcets(network), None, 120 * MS)
    assert found[1] == age * MS
    assert reaction * MS - output * MS < found[0] <= reaction * MS


@pytest.mark.parametrize("order", ["first || second", "second ||> first", "first ||> second"])
def test_values_passed_within_a_sample_do_not_age(order: str) -> None:
    """Two loops of one period that meet in every sample."""
    runs = {"first": "mu (first ; c ! made)", "second": "mu (x1 ? own ; c ? taken ; second)"}
    order = " ".join(runs.get(part, part) for part in order.split())
    text = f"""
        submodel First  wcet 100 us {{ in p : double  out y : double  y = p }}
        submodel Second wcet 200 us {{ in p, x : double  out y : double  y = p }}
        process Main {{
          in  x0, x1 : double @ 2 ms
          out y      : double @ 2 ms
          communication {{
            first  : First
            second : Second
            channel c : double
            var made  : double = 0
            var taken : double = 0
            var own   : double = 0
            x0 -> first.p
            first.y -> made
            taken -> second.p
            own -> second.x
            second.y -> y
          }}
          composition {{ {order} }}
        }}
        """
    network = with_bench(text, ["x0", "x1"], ["y"], "1 ms")
    report = timing_report(network)
    reaction, age = bounds(report)
    found = seen(network, wcets(network), None, 40 * MS)
    assert found[0] <= reaction <= found[0] + 1 * MS
    assert found[1] <= age <= found[1] + 1 * MS
