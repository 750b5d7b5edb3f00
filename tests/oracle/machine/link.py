"""A program prepared for running: replicated operators unrolled, every composition numbered, and what each may still
use.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from tests.oracle.programs.text import branches
from tests.oracle.programs.tree import (
    INT,
    After,
    Alt,
    Assign,
    Bin,
    Call,
    Channel,
    Comp,
    Convert,
    Event,
    Expr,
    Field,
    Guarded,
    If,
    If3,
    Index,
    Interrupt,
    Law,
    Lit,
    Make,
    Mu,
    Par,
    Port,
    Program,
    Raise,
    Read,
    Ready,
    Ref,
    Replicated,
    Run,
    Seq,
    Un,
    While,
    Write,
    parts,
    walk,
    with_parts,
)  # fmt: skip


def put(expr: Expr, name: str, value: int) -> Expr:
    """An expression with the variable of a replicator replaced by its number."""

    def inner(part: Expr) -> Expr:
        return put(part, name, value)

    match expr:
        case Ref(other):
            return Lit(value, INT) if other == name else expr
        case Field(of):
            return replace(expr, of=inner(of))
        case Index(of, at):
            return replace(expr, of=inner(of), at=inner(at))
        case Bin(_, left, right):
            return replace(expr, left=inner(left), right=inner(right))
        case Un(_, of) | Convert(of):
            return replace(expr, of=inner(of))
        case Call(_, arguments):
            return replace(expr, arguments=tuple(map(inner, arguments)))
        case If3(condition, yes, no):
            return replace(expr, condition=inner(condition), yes=inner(yes), no=inner(no))
        case Make(pieces):
            return replace(expr, parts=tuple(map(inner, pieces)))
        case _:
            return expr


def _event_put(event: Event, name: str, value: int) -> Event:
    return replace(event, value=put(event.value, name, value)) if isinstance(event, Write) else event


def written_out(node: Comp) -> Comp:
    """Without replicated operators."""
    if isinstance(node, Replicated):
        copies = tuple(written_out(instance(node.body, node.variable, index)) for index in range(node.count))
        match node.operator:
            case "seq":
                return Seq(copies)
            case "par" | "pripar":
                return Par(copies, node.operator == "pripar")
            case _:
                return Alt(tuple(copy for copy in copies if isinstance(copy, Guarded)), node.operator == "prialt")
    return with_parts(node, tuple(written_out(part) for part in parts(node)))


def instance(node: Comp, name: str, value: int) -> Comp:
    """A composition for one value of the variable of a replicator."""
    node = with_parts(node, tuple(instance(part, name, value) for part in parts(node)))
    match node:
        case Assign(_, expr) | Write(_, expr):
            return replace(node, value=put(expr, name, value))
        case Guarded(event, _, when):
            return replace(
                node, event=_event_put(event, name, value), when=None if when is None else put(when, name, value)
            )
        case Mu(_, until) if until is not None:
            return replace(node, until=put(until, name, value))
        case While(condition, _) | If(condition, _, _):
            return replace(node, condition=put(condition, name, value))
        case _:
            return node


End = tuple[str, str]  # a channel or port, and `?` or `!`


@dataclass(eq=False)
class Node:
    """A composition with its number, its parts, and what it may ever do."""

    id: int
    comp: Comp
    inner: list[Node] = field(default_factory=list)
    uses: frozenset[End] = frozenset()
    raises: bool = False  # an exception declared in the program


@dataclass
class Linked:
    program: Program
    root: Node
    nodes: list[Node]
    channels: dict[str, Channel]
    ports: dict[str, Port]
    laws: dict[str, Law]
    variables: tuple[str, ...]
    # For a broadcast, the branches of the outermost parallel that read it: its ends, in the order of the program.
    ends: dict[str, tuple[int, ...]]
    sessions: dict[tuple[int, str], int]  # by the place that reads a sampled input, and the port


def link(program: Program) -> Linked:
    program = replace(program, body=written_out(program.body))
    laws = {law.name: law for law in program.laws}
    nodes: list[Node] = []
    root = _number(program.body, nodes, laws)
    ends: dict[str, tuple[int, ...]] = {}
    for channel in program.channels:
        if channel.kind == "broadcast":
            readers = [i for i, part in enumerate(branches(program)) if (channel.name, "?") in used(part, laws)]
            ends[channel.name] = tuple(readers)
    return Linked(
        program,
        root,
        nodes,
        {channel.name: channel for channel in program.channels},
        {port.name: port for port in program.ports},
        laws,
        tuple(variable.name for variable in program.variables),
        ends,
        _sessions(program, root, laws),
    )


def _sessions(program: Program, root: Node, laws: dict[str, Law]) -> dict[tuple[int, str], int]:
    """For each place, in the order of the text, the first of the sessions of its port that no parallel place has."""
    sampled = {port.name for port in program.ports if port.input and port.period}
    given: dict[tuple[int, str], int] = {}
    before: list[tuple[str, int, tuple[tuple[Node, int], ...]]] = []

    def look(node: Node, path: tuple[tuple[Node, int], ...]) -> None:
        for port in sorted(_reads(node.comp, laws) & sampled):
            taken = {number for other, number, place in before if other == port and _beside(place, path)}
            number = next(number for number in range(len(taken) + 1) if number not in taken)
            given[node.id, port] = number
            before.append((port, number, path))
        for index, part in enumerate(node.inner):
            look(part, (*path, (node, index)))

    look(root, ())
    return given


def _reads(comp: Comp, laws: dict[str, Law]) -> set[str]:
    """The channels and ports that a composition itself reads, without its parts."""
    match comp.event if isinstance(comp, Guarded) else comp:
        case Read(channel, _) | Ready(channel):
            return {channel}
        case Run(name):
            return {source for _, _, source in laws[name].inputs}
        case _:
            return set()


def _beside(one: tuple[tuple[Node, int], ...], other: tuple[tuple[Node, int], ...]) -> bool:
    """Whether two places may run at the same time: in two branches, or in the body of an interrupt and its guard."""
    common = 0
    while common < min(len(one), len(other)) and one[common] == other[common]:
        common += 1
    if common == min(len(one), len(other)):
        return False
    node = one[common][0]
    if isinstance(node.comp, Interrupt):
        guard = one if one[common][1] == 1 else other
        return len(guard) == common + 1
    return isinstance(node.comp, Par)


def _number(comp: Comp, nodes: list[Node], laws: dict[str, Law]) -> Node:
    node = Node(len(nodes), comp)
    nodes.append(node)
    node.inner = [_number(part, nodes, laws) for part in parts(comp)]
    node.uses = frozenset(used(comp, laws))
    node.raises = any(isinstance(part, Raise) for part in walk(comp))
    return node


def used(comp: Comp, laws: dict[str, Law]) -> set[End]:
    found: set[End] = set()
    for part in walk(comp):
        event = part.event if isinstance(part, Guarded) else part
        match event:
            case Read(channel, _) | Ready(channel):
                found.add((channel, "?"))
            case Write(channel, _):
                found.add((channel, "!"))
            case Run(name) if name in laws:
                found |= {(source, "?") for _, _, source in laws[name].inputs}
                found |= {(sink, "!") for _, _, sink, _ in laws[name].outputs}
            case After() | _:
                pass
    return found
