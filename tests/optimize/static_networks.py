"""Random networks of processes that communicate in a known order, as text: several rates, all kinds of channels,
control laws, exits.

A choreography is generated first: what happens at each tick of a hyperperiod, in a possible order. Each process is then
the sequence of the communications in which it takes part, in a loop. Such a network cannot deadlock because of the
order of rendezvous, but it may fault, and miss samples if it waits too long.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from hypothesis import strategies as st

LAW = """submodel Law(gain: double = 0.5) {
  in  x : double
  out y : double

  state s : double = 0.25
  next s = s + gain * (x - s)
  y = s + 0.125 * x
}
"""

PLANT = """submodel Plant {
  in  drive : double
  out {outputs} : double

  state x : double = 1
  state k : int    = 0
  der x = drive - 0.5 * x
  next k = k + 1
{equations}
}
"""


@dataclass
class Member:
    """A process under construction."""

    name: str
    ports: list[str] = field(default_factory=list)
    steps: list[str] = field(default_factory=list)
    reads_sample: int | None = None
    """The period in ticks of the sampled input that it follows."""
    has_law: bool = False


@dataclass
class Choreography:
    """What is known about the network."""

    members: list[Member]
    relations: list[str] = field(default_factory=list)
    outputs: list[str] = field(default_factory=list)


CHANNELS = ["", "", "", "buffer 1", "buffer 3", "overwrite 2"]


def value(draw: st.DrawFn) -> str:
    """A value to send: some may overflow after a while, none divides."""
    return draw(st.sampled_from(["v", "v + 1", "2 * v - w", "w", "v * v", "7"]))


def real(draw: st.DrawFn) -> str:
    """A real value."""
    return draw(st.sampled_from(["r", "r + 0.5", "limit(r * 1.5, -4, 4)", "0.25 * r"]))


@st.composite
def static_networks(draw: st.DrawFn) -> str:
    """An entire program with its environment ``Bench``."""
    members = [Member(f"Member{n}") for n in range(draw(st.integers(2, 5)))]
    network = Choreography(members)
    ticks = draw(st.sampled_from([1, 1, 2, 4, 6]))
    for number, member in enumerate(members):
        if draw(st.integers(0, 2)) == 0 or (number == 0 and draw(st.booleans())):
            member.reads_sample = draw(st.sampled_from([d for d in (1, 2, 3, 4, 6) if ticks % d == 0]))
            member.has_law = draw(st.booleans())
    if not any(member.reads_sample for member in members):
        members[0].reads_sample = 1
    for tick in range(1, ticks + 1):
        order = draw(st.permutations(range(len(members))))
        for number in order:
            period = members[number].reads_sample
            if period is not None and tick % period == 0:
                _sample(network, number)
        for _ in range(draw(st.integers(0, 3))):
            _step(draw, network, tick)
    return _text(draw, network, ticks)


def _sample(network: Choreography, number: int) -> None:
    member = network.members[number]
    port = f"in  x : double @ {member.reads_sample} ms"
    if port not in member.ports:
        member.ports.append(port)
        network.relations.append(f"level{number} -> member{number}.x")
        if member.has_law:
            member.ports.append(f"out y : double @ {member.reads_sample} ms")
            network.outputs.append(f"out y{number} : double @ {member.reads_sample} ms")
            network.relations.append(f"member{number}.y -> y{number}")
    member.steps.append("law" if member.has_law else "x ? r")


def _step(draw: st.DrawFn, network: Choreography, tick: int) -> None:
    number = len(network.relations)
    kind = draw(
        st.sampled_from(
            ["channel", "channel", "channel", "select", "broadcast", "compute", "output", "decide", "again"]
        )
    )
    members = network.members
    one = draw(st.integers(0, len(members) - 1))
    match kind:
        case "channel":
            other = draw(st.integers(0, len(members) - 1).filter(lambda n: n != one))
            channel_kind = draw(st.sampled_from(CHANNELS))
            members[one].ports.append(f"out o{number} : int")
            members[other].ports.append(f"in  i{number} : int")
            members[one].steps.append(f"o{number} ! {value(draw)}")
            members[other].steps.append(f"i{number} ? {draw(st.sampled_from(['v', 'w', 'a[1]', 'a[w % 2 * 0]']))}")
            arrow = f"-> c{number} : int {channel_kind}".rstrip()
            network.relations.append(f"member{one}.o{number} {arrow} -> member{other}.i{number}")
        case "select":
            other = draw(st.integers(0, len(members) - 1).filter(lambda n: n != one))
            members[one].ports.append(f"out o{number} : int")
            members[other].ports.append(f"in  i{number} : int")
            members[one].steps.append(_writing(draw, number))
            members[other].steps.append(_reading(draw, number))
            channel_kind = draw(st.sampled_from(["", "", "", "buffer 2"]))
            arrow = f"-> c{number} : int {channel_kind}".rstrip()
            network.relations.append(f"member{one}.o{number} {arrow} -> member{other}.i{number}")
        case "broadcast" if len(members) > 2:
            readers = draw(st.permutations([n for n in range(len(members)) if n != one]))[:2]
            members[one].ports.append(f"out o{number} : int")
            members[one].steps.append(f"o{number} ! {value(draw)}")
            for reader in readers:
                members[reader].ports.append(f"in  i{number} : int")
                members[reader].steps.append(f"i{number} ? v")
            ends = ", ".join(f"member{reader}.i{number}" for reader in readers)
            network.relations.append(f"member{one}.o{number} -> broadcast -> {ends}")
        case "compute":
            members[one].steps.append(f"w := {value(draw)}")
        case "output":
            period = draw(st.sampled_from(["@ 1 ms", "@ 2 ms", "@ 1 ms immediate", ""]))
            members[one].ports.append(f"out z{number} : double {period}".rstrip())
            members[one].steps.append(f"z{number} ! {real(draw)}")
            network.outputs.append(f"out z{number} : double {period}".rstrip())
            network.relations.append(f"member{one}.z{number} -> z{number}")
        case "decide":
            members[one].steps.append("if v > 3 then w := v - 1 else v := v + 1")
        case _:
            members[one].steps.append(
                draw(
                    st.sampled_from(["if v > 40 then raise Enough", "if w == 5 then raise Enough", "wait 0 ms", "skip"])
                )
            )


def _writing(draw: st.DrawFn, number: int) -> str:
    """Writes a value, or gives up."""
    late = draw(st.sampled_from(["after 500 us", "after 1 ms", "skip"]))
    operator = draw(st.sampled_from(["[]", "[]>"]))
    alternative = f"(o{number} ! {value(draw)} -> skip) {operator} ({late} -> w := 3)"
    return draw(st.sampled_from([f"o{number} ! {value(draw)}", f"({alternative})"]))


def _reading(draw: st.DrawFn, number: int) -> str:
    """Reads a value, or gives up."""
    late = draw(st.sampled_from(["after 500 us", "after 2 ms", "skip"]))
    operator = draw(st.sampled_from(["[]", "[]>"]))
    target = draw(st.sampled_from(["v", "a[1]"]))
    return f"((i{number} ? {target} -> skip) {operator} ({late} -> w := 4))"


def _body(draw: st.DrawFn, member: Member, turns: int | None, delay: str) -> str:
    steps = list(member.steps) or ["skip"]
    if member.reads_sample is None:
        steps.insert(draw(st.integers(0, len(steps))), f"wait {delay}")
    if turns is not None:
        text = " ; ".join(f"({step})" for step in [*steps, "n := n + 1"])
        return f"(mu ({text}) until n == {turns})"
    text = " ; ".join(f"({step})" for step in steps) if len(steps) > 1 else steps[0]
    return f"(mu ({text} ; v := v))" if not member.ports else f"(mu ({text}))"


def _text(draw: st.DrawFn, network: Choreography, ticks: int) -> str:
    turns = draw(st.sampled_from([None, None, 1, 3]))
    delay = draw(st.sampled_from(["1 ms", f"{ticks} ms", f"{ticks} ms", "300 us"]))
    definitions = []
    for member in network.members:
        if not member.ports:
            member.steps.append("wait 1 ms")
        law = ["    law : Law", "    x -> law.x", "    law.y -> y"] if member.has_law else []
        definitions.append(
            "\n".join(
                [
                    f"process {member.name} {{",
                    *(f"  {port}" for port in member.ports),
                    "  communication {",
                    "    var v : int = 1",
                    "    var w : int = 2",
                    "    var n : int = 0",
                    "    var r : double = 0.5",
                    "    var a : int[2] = [0, 0]",
                    *law,
                    "  }",
                    "  composition {",
                    f"    {_body(draw, member, turns, delay)}",
                    "  }",
                    "}",
                ]
            )
        )
    levels = {
        n: m.reads_sample for n, m in enumerate(network.members) if f"level{n} -> member{n}.x" in network.relations
    }
    names = [f"member{n}" for n in range(len(network.members))]
    operator = draw(st.sampled_from(["||", "||", "||>"]))
    running = f" {operator} ".join(draw(st.permutations(names)))
    caught = " catch Enough -> skip" if draw(st.booleans()) else ""
    ports = [f"in level{n} : double @ {period} ms" for n, period in levels.items()] + network.outputs
    plant = PLANT.replace("{outputs}", ", ".join([*(f"level{n}" for n in levels), "spare"]))
    equations = "\n".join([*(f"  level{n} = x + {n} * 0.5" for n in levels), "  spare = double(k)"])
    drives = [port.split()[1] for port in network.outputs]
    used = [f"{name} -> _" for name in drives[1:]] + ([f"{drives[0]} -> plant.drive"] if drives else [])
    top = "\n".join(
        [
            "process Top {",
            *(f"  {port}" for port in draw(st.permutations(ports))),
            "  communication {",
            *(f"    member{n} : {member.name}" for n, member in enumerate(network.members)),
            *(f"    {relation}" for relation in network.relations),
            "  }",
            "  composition {",
            f"    ({running}){caught}",
            "  }",
            "}",
        ]
    )
    bench = "\n".join(
        [
            "environment Bench for Top step 1 ms {",
            "  plant : Plant",
            *(f"  {line}" for line in used),
            *(f"  plant.level{n} -> level{n}" for n in levels),
            *([] if drives else ["  zero -> plant.drive"]),
            "}",
        ]
    )
    plant = plant.replace("{equations}", equations)
    if not drives:
        plant = plant.replace("in  drive : double\n", "in  drive : double = 0\n")
        bench = bench.replace("  zero -> plant.drive\n", "")
    return "\n\n".join(["exception Enough", LAW, *definitions, top, plant, bench]) + "\n"
