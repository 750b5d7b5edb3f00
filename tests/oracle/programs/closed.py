"""Random closed programs: branches that communicate, with all forms of the composition diagram.

Half of them begin with a script, one order in which every communication takes place, and each branch gets its part of
it, so they would all end normally. Then some steps are exchanged, dropped, put into alternatives, interrupts, and so
on.
"""

from __future__ import annotations

from dataclasses import replace
from random import Random

from tests.oracle.programs.forms import MS, Forms, forever
from tests.oracle.programs.scope import MODE, PAIR, TYPES, WIDE_TYPES, Scope, World
from tests.oracle.programs.text import uses
from tests.oracle.programs.tree import BOOL, INT, Channel, Comp, Mu, Par, Port, Program, Read, Wait, Write

KINDS = ("sync", "sync", "sync", "any", "buffer", "overwrite", "broadcast")


def _ends(rng: Random, kind: str, count: int) -> tuple[list[int], list[int]]:
    """Which branches write and which read."""
    order = rng.sample(range(count), count)
    if kind == "broadcast":
        return order[:1], order[1 : 1 + rng.randint(1, 2)] if count < 3 else order[1 : 1 + rng.randint(2, 3)]
    if kind == "any":
        split = rng.randint(1, count - 1)
        return order[: min(split, 2)], order[split : split + 2]
    return order[:1], order[1:2]


def is_wide(seed: int) -> bool:
    """Whether a program computes at the ends of the ranges; for the other seeds, programs are the same as without this
    choice.
    """
    return Random(f"wide {seed}").random() < 0.4


def closed(seed: int, *, without: frozenset[str] = frozenset(), inputs: bool = False, sampled: bool = True) -> Program:
    """A program without inputs, or with some events and samples."""
    rng, shifts = Random(seed), Random(f"offsets {seed}")
    world = World(rng, rich=rng.random() < 0.4, wide=is_wide(seed))
    count = rng.choice([2, 2, 3, 3, 4])
    scopes = [Scope(world, branch, [], [], []) for branch in range(count)]
    ends: dict[str, tuple[list[int], list[int]]] = {}
    for number in range(rng.randint(1, 3)):
        kind = rng.choice([kind for kind in KINDS if kind not in without and (kind != "broadcast" or count > 2)])
        size = rng.randint(1, 2) if kind in ("buffer", "overwrite") else 0
        kinds = (TYPES if world.rich else ()) + (WIDE_TYPES if world.wide else ()) or (INT,)
        channel = Channel(f"c{number}", rng.choice(kinds) if len(kinds) > 1 else INT, kind, size)
        world.channels.append(channel)
        ends[channel.name] = _ends(rng, kind, count)
        for branch in ends[channel.name][0]:
            scopes[branch].writes.append(channel)
        for branch in ends[channel.name][1]:
            scopes[branch].reads.append(channel)
    ports: list[Port] = []
    for scope in scopes:
        if rng.random() < 0.4:
            ports.append(Port(f"o{scope.owner}", False, INT))
            scope.outputs.append(ports[-1].name)
    if inputs:
        for scope in rng.sample(scopes, rng.choice([1, 1, 2])):
            period = rng.choice([None, None, 2 * MS, 5 * MS]) if sampled else None
            kind, domain, values = INT, (-1, 0, 1, 2), (0, 1)
            if world.wide:
                domain, values = (-(2**63), 0, 1, 2**63 - 1), (0, 2**63 - 1)
            if rng.random() < (0.25 if world.wide else 0.6):
                kind, domain, values = BOOL, (False, True), (False, True)
            port = Port(
                f"i{scope.owner}", True, kind, period, domain=domain, values=((0, values[0]), (4_500_000, values[1]))
            )
            if period:
                port = replace(port, offset=shifts.choice([0, 0, MS]))
            ports.append(port)
            scope.reads += [Channel(port.name, kind, "sampled" if period else "event")] * 2
    bodies = _scripted(world, scopes, ends, without) if rng.random() < 0.6 else _free(scopes, without)
    bodies = _both_sides(bodies, world.channels, scopes)
    if rng.random() < 0.25:
        bodies.append(Mu(Wait(rng.choice([1, 2, 3]) * 10**6)))
    boxed = boxes(rng, bodies, world.channels) if rng.random() < 0.4 else frozenset()
    return Program(
        body=Par(tuple(bodies), prioritized=rng.random() < 0.2),
        channels=tuple(world.channels),
        variables=tuple(world.variables),
        ports=tuple(
            port for port in ports if any(port.name + ("?" if port.input else "!") in uses(body, {}) for body in bodies)
        ),
        laws=tuple(world.laws),
        enums=(MODE,),
        structs=(PAIR,),
        exceptions=tuple(sorted(world.exceptions)),
        boxed=boxed,
    )


def _free(scopes: list[Scope], without: frozenset[str]) -> list[Comp]:
    bodies: list[Comp] = []
    for scope in scopes:
        forms = Forms(scope, without)
        steps = forms.steps(scope.rng.randint(1, 4), 2)
        body = forms.sequence(forms.overflowed(steps) if scope.world.wide and scope.rng.random() < 0.6 else steps)
        bodies.append(forms.loop(body) if scope.rng.random() < 0.6 else body)
    return bodies


def _scripted(
    world: World, scopes: list[Scope], ends: dict[str, tuple[list[int], list[int]]], without: frozenset[str]
) -> list[Comp]:
    rng = world.rng
    lists: list[list[Comp]] = [[] for _ in scopes]
    for _ in range(rng.randint(2, 6)):
        channel = rng.choice(world.channels)
        writers, readers = ends[channel.name]
        writer = rng.choice(writers)
        lists[writer].append(Write(channel.name, scopes[writer].value(channel.type)))
        for reader in readers if channel.kind == "broadcast" else [rng.choice(readers)]:
            lists[reader].append(Read(channel.name, scopes[reader].target(channel.type)))
        branch = rng.randrange(len(scopes))
        if rng.random() < 0.5:
            lists[branch] += Forms(scopes[branch], without).local()
    looped = rng.random()
    bodies: list[Comp] = []
    for scope, steps in zip(scopes, lists, strict=True):
        forms = Forms(scope, without)
        for _ in range(rng.choice([0, 0, 0, 1] if world.wide else [0, 0, 1, 1, 2])):
            steps = forms.changed(steps)
        if world.wide and rng.random() < 0.6:
            steps = forms.overflowed(steps)
        body = forms.sequence(steps)
        around = looped < 0.5 or (looped < 0.65 and rng.random() < 0.5)
        bodies.append((forever(body) if looped < 0.4 else forms.loop(body)) if around else body)
    return bodies


def _both_sides(bodies: list[Comp], channels: list[Channel], scopes: list[Scope]) -> list[Comp]:
    """A channel with one side only is refused: a missing side is added at the end of a branch, where it may never be
    reached.
    """
    made = list(bodies)
    for channel in channels:
        for end in "?!":
            ends = set().union(*(uses(body, {}) for body in made))
            if channel.name + end not in ends:
                here = [s for s in scopes if channel in (s.reads if end == "?" else s.writes)]
                for scope in here if channel.kind == "broadcast" else here[:1]:
                    step: Comp = Write(channel.name, scope.value(channel.type))
                    if end == "?":
                        step = Read(channel.name, scope.target(channel.type))
                    made[scope.owner] = Forms(scope, frozenset()).sequence([made[scope.owner], step])
    return made


def boxes(rng: Random, bodies: list[Comp], channels: list[Channel]) -> frozenset[int]:
    """Some branches as processes of their own, together with all branches that share a channel with them."""
    used = [{end[:-1] for end in uses(body, {})} for body in bodies]
    ends = set().union(*(uses(body, {}) for body in bodies))
    halves = {channel.name for channel in channels if (channel.name + "!" in ends) != (channel.name + "?" in ends)}
    boxed = {rng.randrange(len(bodies))}
    names = {channel.name for channel in channels}
    while True:
        shared = set().union(*(used[branch] for branch in boxed)) & names
        more = {branch for branch in range(len(bodies)) if used[branch] & shared}
        if more <= boxed:
            return frozenset() if shared & halves else frozenset(boxed)
        boxed |= more
