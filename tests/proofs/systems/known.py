"""Systems with known numbers of states, deadlocks and lengths of the shortest trace, built directly from machines.

They come from the literature (Dijkstra; Milner; Welch, Justo and Willcock; Bartlett, Scantlebury and Wilkinson;
Martin); every machine has events of two parties, or of one with the environment.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from cspdiag.proofs.transitions.systems.system import INTERNAL, Component, Event, EventKind, System

Table: TypeAlias = Mapping[str, Sequence[tuple[str, str]]]
"""For each state, its edges: the name of an event (``tau`` is internal) and the state after it. The first state is the
initial one.
"""


@dataclass(frozen=True)
class Machine:
    name: str
    table: Table
    terminal: frozenset[str] = frozenset()
    process: bool = True


def compose(
    machines: Iterable[Machine], kinds: Mapping[str, EventKind] | None = None, visible: Iterable[str] = ()
) -> System:
    """The machines in parallel: an event belongs to all that have an edge with its name."""
    machines = tuple(machines)
    parties: dict[str, list[int]] = {}
    for index, machine in enumerate(machines):
        for edges in machine.table.values():
            for event, _ in edges:
                if event != "tau" and (not parties.setdefault(event, []) or parties[event][-1] != index):
                    parties[event].append(index)
    number = {event: at for at, event in enumerate(parties)}
    shown = frozenset(visible)
    events = tuple(
        Event(
            channel=event,
            parties=tuple(members),
            kind=(kinds or {}).get(event, "communication" if len(members) > 1 else "external"),
            visible=event in shown,
        )
        for event, members in parties.items()
    )
    return System(tuple(_component(machine, number) for machine in machines), events)


def _component(machine: Machine, number: Mapping[str, int]) -> Component:
    state = {name: at for at, name in enumerate(machine.table)}
    edges = tuple(
        tuple((INTERNAL if event == "tau" else number[event], state[after]) for event, after in table)
        for table in machine.table.values()
    )
    terminal = frozenset(state[name] for name in machine.terminal)
    return Component(machine.name, edges, terminal, process=machine.process)


def cycle(name: str, *events: str) -> Machine:
    """A machine that repeats the events in this order."""
    return Machine(name, {str(at): [(event, str((at + 1) % len(events)))] for at, event in enumerate(events)})


def philosophers(number: int, left_handed: int = 0) -> System:
    """Philosophers who think, pick left, pick right, eat, put right, put left; for ``left_handed`` of them the sides
    are exchanged.
    """
    machines = []
    for at in range(number):
        one, other = at, (at + 1) % number
        if at < left_handed:
            one, other = other, one
        picks = (f"pick{at}.{one}", f"pick{at}.{other}")
        puts = (f"put{at}.{other}", f"put{at}.{one}")
        machines.append(cycle(f"philosopher{at}", f"think{at}", *picks, f"eat{at}", *puts))
    for at in range(number):
        one, other = at, (at - 1) % number
        table = {
            "free": [(f"pick{one}.{at}", "one"), (f"pick{other}.{at}", "other")],
            "one": [(f"put{one}.{at}", "free")],
            "other": [(f"put{other}.{at}", "free")],
        }
        machines.append(Machine(f"fork{at}", table))
    return compose(machines)


def milner(number: int) -> System:
    """Milner's scheduler: the cells start their tasks in turn, and a task ends before its cell starts it again."""
    machines = []
    for at in range(number):
        take, give, begin, end = f"token{at}", f"token{(at + 1) % number}", f"begin{at}", f"end{at}"
        table = {
            "waits": [(take, "begins")],
            "begins": [(begin, "both")],
            "both": [(give, "ends"), (end, "gives")],
            "ends": [(end, "waits")],
            "gives": [(give, "waits")],
        }
        if at == 0:
            table = {"begins": table.pop("begins"), **table}
        machines.append(Machine(f"cell{at}", table))
    return compose(machines)


def token_ring(number: int) -> System:
    """Stations that may wish to work at any time, and work when they have the token."""
    machines = []
    for at in range(number):
        take, give = f"token{at}", f"token{(at + 1) % number}"
        wish, enter, leave = f"wish{at}", f"enter{at}", f"leave{at}"
        table = {
            "idle": [(take, "idle with token"), (wish, "wishes")],
            "wishes": [(take, "wishes with token")],
            "idle with token": [(give, "idle"), (wish, "wishes with token")],
            "wishes with token": [(enter, "works")],
            "works": [(leave, "gives")],
            "gives": [(give, "idle")],
        }
        if at == 0:
            table = {"idle with token": table.pop("idle with token"), **table}
        machines.append(Machine(f"station{at}", table))
    return compose(machines)


def io_par_ring(number: int) -> System:
    """Processes that read and write in parallel, compute, and start again."""
    machines = []
    for at in range(number):
        read, write = f"c{at}", f"c{(at + 1) % number}"
        table = {
            "both": [(read, "writes"), (write, "reads")],
            "writes": [(write, "computes")],
            "reads": [(read, "computes")],
            "computes": [(f"compute{at}", "both")],
        }
        machines.append(Machine(f"node{at}", table))
    return compose(machines)


def io_seq_ring(number: int) -> System:
    """Processes that write, then read: all wait at once."""
    return compose(cycle(f"node{at}", f"c{(at + 1) % number}", f"c{at}") for at in range(number))


def _server(name: str, above: str, below: str | None, starts: bool) -> Machine:
    """A process that serves requests from above by making one below for each; with ``starts`` it also makes requests
    for itself.
    """
    table: dict[str, list[tuple[str, str]]] = {"idle": []}
    if above:
        table["idle"].append((f"request{above}", "asked"))
        if below is None:
            table["asked"] = [(f"reply{above}", "idle")]
        else:
            table["asked"] = [(f"request{below}", "waits")]
            table["waits"] = [(f"reply{below}", "answers")]
            table["answers"] = [(f"reply{above}", "idle")]
    if starts:
        table["idle"].append((f"start{name}", "wants"))
        table["wants"] = [(f"request{below}", "waits for itself")]
        table["waits for itself"] = [(f"reply{below}", "idle")]
    return Machine(name, table)


def client_server_chain(number: int) -> System:
    """A client, and servers each of which sends requests to the next."""
    return compose(
        _server(f"p{at}", str(at) if at else "", str(at + 1) if at + 1 < number else None, starts=at == 0)
        for at in range(number)
    )


def client_server_ring(number: int) -> System:
    """Processes that are clients of the next and servers of the previous one."""
    return compose(_server(f"p{at}", str(at), str((at + 1) % number), starts=True) for at in range(number))


def with_loop(system: System) -> System:
    """The system, and two processes that communicate forever and have nothing to do with it."""
    ask, answer = len(system.events), len(system.events) + 1
    first = len(system.components)
    pair = tuple(Component(name, (((ask, 1),), ((answer, 0),))) for name in ("loop asker", "loop answerer"))
    events = tuple(Event(name, (first, first + 1)) for name in ("loop ask", "loop answer"))
    return System(system.components + pair, system.events + events)


def alternating_bit(lossy: bool = True) -> System:
    """The alternating bit protocol over media of one place; if the media lose nothing, the time-out leads to a
    deadlock.
    """
    sender: dict[str, list[tuple[str, str]]] = {}
    receiver: dict[str, list[tuple[str, str]]] = {}
    for bit, other in ((0, 1), (1, 0)):
        sender[f"accepts {bit}"] = [("accept", f"sends {bit}")]
        sender[f"sends {bit}"] = [(f"send{bit}", f"waits {bit}")]
        sender[f"waits {bit}"] = [
            (f"acknowledged{bit}", f"accepts {other}"),
            (f"acknowledged{other}", f"waits {bit}"),
            ("timeout", f"sends {bit}"),
        ]
        receiver[f"waits {bit}"] = [(f"received{bit}", f"delivers {bit}"), (f"received{other}", f"repeats {other}")]
        receiver[f"delivers {bit}"] = [("deliver", f"acknowledges {bit}")]
        receiver[f"acknowledges {bit}"] = [(f"acknowledge{bit}", f"waits {other}")]
        receiver[f"repeats {other}"] = [(f"acknowledge{other}", f"waits {bit}")]
    machines = [
        Machine("sender", sender),
        Machine("receiver", receiver),
        _medium("there", "send", "received", lossy),
        _medium("back", "acknowledge", "acknowledged", lossy),
    ]
    return compose(machines, kinds={"timeout": "time"}, visible=("accept", "deliver"))


def _medium(name: str, taken: str, given: str, lossy: bool) -> Machine:
    table = {"empty": [(f"{taken}{bit}", f"has {bit}") for bit in (0, 1)]}
    for bit in (0, 1):
        table[f"has {bit}"] = [(f"{given}{bit}", "empty")] + ([("tau", "empty")] if lossy else [])
    return Machine(name, table)


MODES = 4


def controller(joints: int, commits: bool = False) -> System:
    """Joints, each with four modes in sequence, a sensor, a timer, an actuator and an overwriting log; a supervisor, a
    stop button, a display.

    A joint reports the end of its modes, and can be halted between steps; if the last joint ``commits`` to its report,
    it cannot be halted then.
    """
    machines = [
        Machine("button", {"up": [("press", "down")], "down": [("stop", "up")]}),
        _supervisor(joints),
        cycle("display", "show", "draw"),
    ]
    for joint in range(joints):
        machines += _joint(joint, commits and joint == joints - 1)
    return compose(machines)


def _supervisor(joints: int) -> Machine:
    table = {"watches": [(f"done{joint}", "shows") for joint in range(joints)] + [("stop", "halts 0")]}
    for joint in range(joints):
        after = f"halts {joint + 1}" if joint + 1 < joints else "shows"
        table[f"halts {joint}"] = [(f"halt{joint}", after)]
    table["shows"] = [("show", "watches")]
    return Machine("supervisor", table)


def _joint(joint: int, commits: bool) -> list[Machine]:
    modes: dict[str, list[tuple[str, str]]] = {}
    for mode in range(MODES):
        after = f"idle {mode + 1}" if mode + 1 < MODES else "reports"
        modes[f"idle {mode}"] = [(f"tick{joint}", f"senses {mode}"), (f"halt{joint}", "idle 0")]
        modes[f"senses {mode}"] = [(f"sample{joint}", f"drives {mode}")]
        modes[f"drives {mode}"] = [(f"drive{joint}", f"logs {mode}")]
        modes[f"logs {mode}"] = [(f"log{joint}", f"idle {mode}"), (f"log{joint}", after)]
    modes["reports"] = [(f"done{joint}", "idle 0")] + ([] if commits else [(f"halt{joint}", "idle 0")])
    return [
        Machine(f"joint{joint}", modes),
        cycle(f"sensor{joint}", f"measure{joint}", f"sample{joint}"),
        cycle(f"timer{joint}", f"period{joint}", f"tick{joint}"),
        cycle(f"actuator{joint}", f"drive{joint}", f"move{joint}"),
        Machine(f"log{joint}", {"holds": [(f"log{joint}", "holds")]}, process=False),
    ]


def table_with_butler(seats: int, admitted: int) -> System:
    """Philosophers with the same hand; a butler lets at most ``admitted`` of them sit down at once."""
    machines = []
    for at in range(seats):
        left, right = f"{at}.{at}", f"{at}.{(at + 1) % seats}"
        machines.append(
            cycle(
                f"philosopher{at}", f"sit{at}", f"pick{left}", f"pick{right}", f"put{left}", f"put{right}", f"rise{at}"
            )
        )
    for at in range(seats):
        one, other = f"{at}.{at}", f"{(at - 1) % seats}.{at}"
        table = {
            "free": [(f"pick{one}", "one"), (f"pick{other}", "other")],
            "one": [(f"put{one}", "free")],
            "other": [(f"put{other}", "free")],
        }
        machines.append(Machine(f"fork{at}", table))
    butler: dict[str, list[tuple[str, str]]] = {}
    for seated in range(admitted + 1):
        arrivals = [(f"sit{at}", f"{seated + 1}") for at in range(seats)] if seated < admitted else []
        departures = [(f"rise{at}", f"{seated - 1}") for at in range(seats)] if seated else []
        butler[f"{seated}"] = arrivals + departures
    return compose([*machines, Machine("butler", butler)])


def counted_meals(seats: int, meals: int = 3, *, one_left_handed: bool = True) -> System:
    """Philosophers, the last one perhaps with the other hand, each with a number of meals; a fork only counts how often
    it is taken.
    """
    machines = []
    for at in range(seats):
        picks = [f"{at}.{at}", f"{at}.{(at + 1) % seats}"]
        if at == seats - 1 and one_left_handed:
            picks.reverse()
        steps = [f"{done}{fork}" for _ in range(meals) for done in ("pick", "put") for fork in picks]
        machines.append(line(f"philosopher{at}", steps))
    for at in range(seats):
        table: dict[str, list[tuple[str, str]]] = {f"{2 * meals}": []}
        for uses in range(2 * meals):
            users = (f"{at}.{at}", f"{(at - 1) % seats}.{at}")
            table[f"{uses}"] = [(f"pick{user}", f"{uses} {user}") for user in users]
            table |= {f"{uses} {user}": [(f"put{user}", f"{uses + 1}")] for user in users}
        first = {"0": table.pop("0")}
        machines.append(Machine(f"fork{at}", first | table, terminal=frozenset({f"{2 * meals}"})))
    return compose(machines)


def line(name: str, events: list[str]) -> Machine:
    """A machine that takes the events in this order, and ends."""
    steps: dict[str, list[tuple[str, str]]] = {str(at): [(event, str(at + 1))] for at, event in enumerate(events)}
    return Machine(name, {**steps, str(len(events)): []}, terminal=frozenset({str(len(events))}))
