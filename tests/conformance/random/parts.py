"""Random programs in which parallel parts of a few processes communicate with each other, most of which deadlock.

A script of communications, whose projections on the parts would be a program without a deadlock, is changed in a few
places, so it is followed for a while.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from random import Random
from typing import NamedTuple

from tests.conformance.random.nodes import Node, Program

TOP = "Main"
KINDS = ["", "", "any", "any", "broadcast", "buffer(1)"]


@dataclass
class Channel:
    """A channel with the parts at its sides, by their numbers."""

    name: str
    kind: str
    writers: list[int]
    readers: list[int]


class Action(NamedTuple):
    """A communication through a channel."""

    channel: str
    text: str


@dataclass
class Part:
    """A parallel part of a process, with what it does one after the other."""

    owner: str
    number: int
    actions: list[Action] = field(default_factory=list)

    def action(self, channel: Channel, draw: Random) -> Action:
        """A communication of this part through one of its channels."""
        if self.number in channel.writers:
            return Action(channel.name, f"{channel.name} ! {draw.randint(0, 9)}")
        return Action(channel.name, f"{channel.name} ? v{self.number}")


def parts(seed: int) -> Program:
    """The program of a seed."""
    draw = Random(f"parts {seed}")
    owners = [TOP, "A", "B"][: draw.randint(1, 3)]
    found = [Part(owner, 0) for owner in owners for _ in range(draw.choice([2, 2, 3, 4]))]
    for number, part in enumerate(found):
        part.number = number
    channels = [_channel(draw, found, f"c{number}") for number in range(draw.randint(3, 6))]
    for _ in range(draw.randint(8, 16)):
        channel = draw.choice(channels)
        readers = channel.readers if channel.kind == "broadcast" else [draw.choice(channel.readers)]
        for number in (draw.choice(channel.writers), *readers):
            found[number].actions.append(found[number].action(channel, draw))
    for _ in range(draw.randint(1, 3)):
        _change(draw, draw.choice(found), channels)
    bodies = {owner: _body(draw, [part for part in found if part.owner == owner], channels) for owner in owners}
    leaves = [(owner, _declared(owner, found, channels), body) for owner, body in bodies.items() if owner != TOP]
    instances = [f"{owner.lower()} : {owner}" for owner, _, _ in leaves]
    connections = [each for channel in channels for each in _connections(channel, found)]
    after = "\n".join(
        [
            f"process {TOP} {{",
            _declared(TOP, found, channels, [*instances, *connections]),
            "  composition {",
            "    {top}" + "".join(f"\n    || {owner.lower()}" for owner, _, _ in leaves),
            "  }",
            "}",
            f"environment Bench for {TOP} {{ }}",
        ]
    )
    return Program("", tuple(leaves), after, bodies[TOP])


def _channel(draw: Random, found: list[Part], name: str) -> Channel:
    kind = draw.choice(KINDS)
    # Mostly within one process.
    writer = draw.choice(found)
    near = [part for part in found if part.owner == writer.owner and part is not writer]
    far = [part for part in found if part.owner != writer.owner]
    others = near if draw.random() < 0.7 or not far else far
    draw.shuffle(others)
    count = draw.randint(1, 2) if kind in ("any", "broadcast") else 1
    readers = [part.number for part in others[:count]]
    writers = [writer.number]
    if kind == "any" and draw.random() < 0.5:
        writers += [part.number for part in near if part.number not in readers][:1]
    return Channel(name, kind, writers, readers)


def _change(draw: Random, part: Part, channels: list[Channel]) -> None:
    """One change of what a part does."""
    actions, kind = part.actions, draw.choice(["swap", "swap", "drop", "add"])
    own = [channel for channel in channels if part.number in (*channel.writers, *channel.readers)]
    position = draw.randint(len(actions) // 2, len(actions))
    if kind == "swap" and len(actions) > 1:
        position = min(max(position, 1), len(actions) - 1)
        actions[position - 1], actions[position] = actions[position], actions[position - 1]
    elif kind == "drop" and position < len(actions):
        del actions[position]
    elif own:
        actions.insert(position, part.action(draw.choice(own), draw))


def _body(draw: Random, found: list[Part], channels: list[Channel]) -> Node:
    return Node("", tuple(_part(draw, part, channels) for part in found), "\n    || ")


def _part(draw: Random, part: Part, channels: list[Channel]) -> Node:
    own = [channel for channel in channels if part.number in (*channel.writers, *channel.readers)]
    steps: list[Node] = []
    position = 0
    while position < len(part.actions):
        channel, text = part.actions[position]
        position += 1
        choice = draw.random()
        # The guards of an alternative, and what runs in parallel, use channels and variables of their own.
        different = [each for each in own if each.name != channel]
        other = part.action(draw.choice(different), draw).text if different else "after 1 ms"
        following = part.actions[position] if position < len(part.actions) else None
        if choice < 0.08:
            steps.append(Node(f"({text} -> {{}} [] {other} -> {{}})", (Node(), Node())))
        elif choice < 0.13:
            steps.append(Node(f"(({{}}) interrupt {other} -> {{}})", (Node(text), Node())))
        elif choice < 0.25 and following is not None and following.channel != channel:
            second = Node(following.text.replace("? v", "? w"))
            steps.append(Node("", (Node(text), second), " || "))
            position += 1
        elif choice < 0.27:
            steps.append(Node(f"({text} || stop)"))
        else:
            steps.append(Node(text))
        if draw.random() < 0.15:
            steps.append(Node("wait 1 ms"))
    loops = steps and draw.random() < 0.15
    if loops:
        steps.append(Node("wait 1 ms"))  # Loops that meet in no time would run forever.
    made = Node("", tuple(steps), " ; ") if steps else Node()
    return Node("(mu {})" if loops else "({})", (made,))


def _declared(owner: str, found: list[Part], channels: list[Channel], more: list[str] | None = None) -> str:
    """The ports and the communication diagram of a process."""
    numbers = {part.number for part in found if part.owner == owner}
    ports, inside = [], []
    for channel in channels:
        owners = {found[number].owner for number in (*channel.writers, *channel.readers)}
        if owners == {owner} or (owner == TOP and TOP in owners):
            inside.append(f"channel {channel.name} : int {channel.kind}")
        elif owner in owners and owner != TOP:
            direction = "out" if numbers & {*channel.writers} else "in"
            ports.append(f"  {direction} {channel.name} : int")
    inside += [f"var {letter}{number} : int = 0" for number in sorted(numbers) for letter in "vw"]
    lines = "\n".join(f"    {line}" for line in [*inside, *(more or ())])
    return "\n".join([*ports, f"  communication {{\n{lines}\n  }}"])


def _connections(channel: Channel, found: list[Part]) -> list[str]:
    """The relationships of a channel between processes, in the outermost one."""
    writers = dict.fromkeys(found[number].owner for number in channel.writers)
    readers = dict.fromkeys(found[number].owner for number in channel.readers)
    if len({*writers, *readers}) == 1:
        return []
    sources = [channel.name if owner == TOP else f"{owner.lower()}.{channel.name}" for owner in writers]
    sinks = [channel.name if owner == TOP else f"{owner.lower()}.{channel.name}" for owner in readers]
    if TOP in (*writers, *readers):
        joined = [f"{source} -> {channel.name}" for source in sources if source != channel.name]
        return joined + [f"{channel.name} -> {sink}" for sink in sinks if sink != channel.name]
    kind = f"-> {channel.kind} ->" if channel.kind else "->"
    return [f"{', '.join(sources)} {kind} {', '.join(sinks)}"]
