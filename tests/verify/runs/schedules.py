"""All schedules of small closed programs, by the plain interpreter of the language: can they reach a deadlock?

Any ready process of the highest level may run, and any ready guard of ``[]`` may be chosen; times are exact. None of
this is shared with replays.
"""

from __future__ import annotations

from collections.abc import Sequence
from random import Random

from cspdiag.network.ir.network import Network
from cspdiag.semantics.execute import execute
from cspdiag.semantics.requests import Task
from cspdiag.semantics.scheduler import Scheduler
from cspdiag.verify.decisions import Decisions


class TooManyError(Exception):
    """There are more schedules than were allowed."""


def endings(network: Network, most: int) -> set[str]:
    """How a program without ports may end, over all its schedules. Raises TooManyError if there are more than
    ``most``.
    """
    decisions = Decisions()

    class AnyOrder(Scheduler):
        def next_task(self, ready: Sequence[Task]) -> Task:
            return ready[decisions.choose(len(ready))] if len(ready) > 1 else ready[0]

        def fair(self, ready: Sequence[int], last: int) -> int:
            return ready[decisions.choose(len(ready))] if len(ready) > 1 else ready[0]

    found: set[str] = set()
    for _ in range(most):
        decisions.begin()
        found.add(execute(network, scheduler=AnyOrder).ending.ended)
        if not decisions.advance():
            return found
    raise TooManyError


def small_program(random: Random) -> str:
    """A closed program of three processes that end, or get stuck, with delays, alternatives and priorities."""
    channels = [_Channel(number, random) for number in range(3)]
    processes = [_process(name, channels, random) for name in "abc"]
    arrows = "".join(f"    {c.writer}.{c.name} -> {c.kind}{c.reader}.{c.name}\n" for c in channels)
    operator = random.choice(["||", "||", "||>"])
    order = random.sample("abc", 3)
    composition = f" {operator} ".join(order)
    if random.random() < 0.3:
        composition = f"({order[0]} || {order[1]}) ||> {order[2]}"
    instances = "".join(f"    {name} : {name.upper()}\n" for name in "abc")
    return (
        "".join(processes) + f"process All {{\n  communication {{\n{instances}{arrows}  }}\n"
        f"  composition {{ {composition} }}\n}}\n\nassert All deadlock free\n"
    )


class _Channel:
    def __init__(self, number: int, random: Random) -> None:
        self.name = f"c{number}"
        self.writer, self.reader = random.sample("abc", 2)
        self.kind = random.choice(["", "", "", "buffer 1 -> ", "overwrite 1 -> "])


def _process(name: str, channels: Sequence[_Channel], random: Random) -> str:
    outputs = [c.name for c in channels if c.writer == name]
    inputs = [c.name for c in channels if c.reader == name]
    ports = "".join(f"  out {c} : int\n" for c in outputs) + "".join(f"  in {c} : int\n" for c in inputs)
    plain = [f"{c} ! 1" for c in outputs] + [f"{c} ? v" for c in inputs]
    # Every port is used somewhere, so the channel has both its ends.
    steps = random.sample(plain, len(plain)) + [_step(plain, random) for _ in range(random.randrange(3))]
    random.shuffle(steps)
    return (
        f"process {name.upper()} {{\n{ports}\n  communication {{ var v : int = 0 }}\n\n"
        f"  composition {{ {' ; '.join(steps) or 'skip'} ; skip }}\n}}\n\n"
    )


def _step(plain: Sequence[str], random: Random) -> str:
    delay = f"{random.choice([0, 1, 1, 2, 3])} ms"
    if random.random() < 0.4 or not plain:
        return f"wait {delay}"
    guards = random.sample(plain, random.randint(1, min(2, len(plain))))
    last = random.choice([f"after {delay}", f"after {delay}", "skip"])
    operator = random.choice([" [] ", " []> "])
    ends = ["skip", "skip", "stop", f"wait {delay}", *plain]
    return "(" + operator.join(f"{guard} -> {random.choice(ends)}" for guard in (*guards, last)) + ")"
