"""Random programs of arrays whose elements are joined to those before, beside or after them, and to single instances at
the ends.
"""

from __future__ import annotations

import random
import re
from collections.abc import Sequence
from typing import NamedTuple

BODIES = ("each", "each", "each", "each", "chosen", "counted", "compared")


class _Array(NamedTuple):
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    body: str


def joined_arrays(seed: int, size: int) -> str:
    """A program, the same for all sizes but for the numbers of elements."""
    chosen = random.Random(seed)
    arrays: list[list[list[str]]] = [[[], []] for _ in range(chosen.randint(1, 3))]
    lines: list[str] = []
    singles: list[str] = []
    for number in range(chosen.randint(1, 4)):
        source, sink = chosen.randrange(len(arrays)), chosen.randrange(len(arrays))
        arrays[source][1].append(f"o{number}")
        arrays[sink][0].append(f"i{number}")
        lines += _joined(chosen, f"a{source}", f"o{number}", f"a{sink}", f"i{number}", singles)
    definitions = [_process(chosen, f"A{number}", inputs, outputs) for number, (inputs, outputs) in enumerate(arrays)]
    declared = [f"a{number}[size] : A{number}" for number in range(len(arrays))]
    declared += [f"{name} : {kind}" for kind, name in (single.split() for single in singles)]
    kinds = {single.split()[0] for single in singles}
    composed = [f"(par i < size : a{number}[i])" for number in range(len(arrays))]
    composed += [single.split()[1] for single in singles]
    text = [f"const size = {size}", *(SINGLES[kind] for kind in sorted(kinds)), *definitions]
    text += ["process Whole {", "communication {", *declared, *lines, "}"]
    text += ["composition {", " || ".join(composed), "}", "}", "assert Whole deadlock free", ""]
    return "\n".join(text)


SINGLES = {
    "Source": "process Source { out o : int composition { mu o ! 1 } }",
    "Sink": "process Sink { in i : int communication { var x : int } composition { mu i ? x } }",
    "Link": "process Link { in i : int out o : int communication { var x : int } composition { mu (i ? x ; o ! x) } }",
    "Head": "process Head { in i : int out o : int communication { var x : int = 0 } "
    "composition { mu (o ! x ; i ? x) } }",
}


def _joined(
    chosen: random.Random, source: str, output: str, sink: str, given: str, singles: list[str]
) -> Sequence[str]:
    """Relationships from each element, and those of the elements at the ends."""
    form = chosen.choice(["beside", "beside", "after", "before", "around", "opposite"])
    if form == "beside":
        return [f"for i < size {{ {source}[i].{output} -> {sink}[i].{given} }}"]
    if form == "around":
        return [f"for i < size {{ {source}[i].{output} -> {sink}[(i + 1) % size].{given} }}"]
    if form == "opposite":
        return [f"for i < size {{ {source}[i].{output} -> {sink}[size - 1 - i].{given} }}"]
    here, there, last, first = ("i", "i + 1", "size - 1", "0") if form == "after" else ("i + 1", "i", "0", "size - 1")
    lines = [f"for i < size - 1 {{ {source}[{here}].{output} -> {sink}[{there}].{given} }}"]
    name = f"s{len(singles)}"
    end = chosen.choice(["open", "Link", "Head", "closed"])
    if end == "closed":
        return [*lines, f"{source}[{last}].{output} -> {sink}[{first}].{given}"]
    if end == "open":
        singles += [f"Sink {name}", f"Source t{name}"]
        return [*lines, f"{source}[{last}].{output} -> {name}.i", f"t{name}.o -> {sink}[{first}].{given}"]
    singles.append(f"{end} {name}")
    return [*lines, f"{source}[{last}].{output} -> {name}.i", f"{name}.o -> {sink}[{first}].{given}"]


def _process(chosen: random.Random, name: str, inputs: Sequence[str], outputs: Sequence[str]) -> str:
    steps = [*(f"{port} ? x" for port in inputs), *(f"{port} ! x" for port in outputs)] or ["wait 1 ms"]
    chosen.shuffle(steps)
    ports = "".join(f" in {port} : int" for port in inputs) + "".join(f" out {port} : int" for port in outputs)
    body = _body(chosen.choice(BODIES), steps)
    variables = " ".join(f"var {name} : int = 0" for name in "nx" if f" {name}" in body)
    return f"process {name} {{{ports} communication {{ {variables} }} composition {{ {body} }} }}"


def _body(form: str, steps: Sequence[str]) -> str:
    together = " ; ".join(steps)
    match form:
        case "chosen" if not steps[0].startswith("wait"):
            return f"mu ({' [] '.join(f'{step} -> skip' for step in steps)})"
        case "counted":
            return f"mu ({together} ; n := (n + 1) % 3)"
        case "compared":
            return f"mu ({together} ; if x == 100 then stop)"
        case _:
            return f"mu ({together})"


SERVERS = (
    "mu (alt i < size : request[i] ? x -> reply[i] ! x)",
    "mu (alt i < size : request[i] ? x -> (reply[i] ! x ; reply[i] ! x))",
    "mu (alt i < size : request[i] ? x -> (request[i] ? x ; reply[i] ! x))",
    "mu (alt i < size : request[i] ? x -> (alt k < size : request[k] ? x -> (reply[i] ! x ; reply[k] ! x)))",
    "mu (alt i < size : request[i] ? x -> (alt k < size : reply[k] ! x -> skip))",
    "mu ((alt i < size : request[i] ? x -> skip) [] (alt i < size : reply[i] ! x -> skip))",
    "mu (if n < 30 then (alt i < size : request[i] ? x -> n := n + 1) else (alt i < size : reply[i] ! x -> n := 0))",
    "mu (alt i < size : when x != i & request[i] ? x -> reply[i] ! x)",
    "mu (alt i < size : request[i] ? x -> if x == 100 then stop else reply[i] ! x)",
    "mu (alt i < size : request[i] ? x -> reply[(i + 1) % size] ! x)",
    "mu (alt i < size : reply[i] ! x -> request[i] ? x)",
)
CLIENTS = (
    "mu (request ! x ; reply ? x)",
    "mu (request ! x ; reply ? x ; reply ? x)",
    "mu (request ! x ; request ! x ; reply ? x)",
    "mu (reply ? x ; request ! x)",
    "mu (request ! x -> skip [] reply ? x -> skip)",
    "mu (request ! x ; wait 1 ms ; reply ? x)",
)


def served_array(seed: int, size: int) -> str:
    """A program of clients of one server."""
    chosen = random.Random(seed)
    server, client = chosen.choice(SERVERS), chosen.choice(CLIENTS)
    counter = "var n : int = 0" if " n " in server else ""
    return "\n".join(
        [f"const size = {size}", "process Server { in request[size] : int out reply[size] : int",
         f"communication {{ var x : int = 0 {counter} }}", f"composition {{ {server} }} }}",
         "process Client { out request : int in reply : int communication { var x : int = 0 }",
         f"composition {{ {client} }} }}", "process Whole { communication { server : Server client[size] : Client",
         "for i < size { client[i].request -> server.request[i]", "server.reply[i] -> client[i].reply }", "}",
         "composition { server || (par i < size : client[i]) } }", "assert Whole deadlock free", ""]
    )  # fmt: skip


def pausing(text: str, seed: int) -> str:
    """The program with delays after some of its communications, at random, and asserted to be free from livelock."""
    chosen = random.Random(seed)
    often = chosen.choice([0.1, 0.3, 0.6])

    def paused(match: re.Match[str]) -> str:
        return f"({match[0]} ; wait 1 ms)" if chosen.random() < often else match[0]

    text = re.sub(r"\w+(?:\[[^]]*\])? [!?] \w+(?! *->)(?! \+)", paused, text)
    return text.replace("deadlock free", "livelock free")
