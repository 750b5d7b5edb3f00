"""Networks as CSPm scripts, for FDR (the syntax of Roscoe, "Understanding Concurrent Systems", and of the manual of FDR
4).

Each component is a set of processes, one per state; the system is their alphabetized parallel composition. Internal
steps are hidden events. A process that has ended offers ``ended`` forever, in which all processes take part, so an end
of all is not a deadlock while a part that waits for an ended process is one.
"""

from __future__ import annotations

from collections.abc import Iterator

from cspdiag.codegen.shared.identifiers import distinct
from cspdiag.codegen.shared.models import system_of
from cspdiag.codegen.shared.plain_text import one_line
from cspdiag.network.ir.network import CoreNetwork
from cspdiag.proofs.transitions.systems.system import INTERNAL, System


def generate(network: CoreNetwork) -> dict[str, str]:
    """The script of a network, by path. Raises TargetError where it would have too many states."""
    text = cspm(system_of(network), network.source)
    return {f"{network.name}.csp": text}


def cspm(system: System, source: str = "") -> str:
    """The CSPm script of a transition system, with assertions of freedom from deadlock and from livelock."""
    return "".join(f"{line}\n" for line in _lines(system, source))


def _lines(system: System, source: str) -> Iterator[str]:
    events = distinct((str(event) for event in system.events), "e_")
    names = distinct((component.name for component in system.components), "P_")
    internal = [f"i_{index}" for index in range(len(system.components))]
    yield f"-- {one_line(source)}: {len(system.components)} components, {len(system.events)} events"
    yield ""
    for event, name in zip(system.events, events, strict=True):
        yield f"channel {name} -- {one_line(str(event))}"
    for name, component in zip(internal, system.components, strict=True):
        yield f"channel {name} -- an internal step of {one_line(component.name)}"
    yield "channel ended -- all processes have ended"
    for index, component in enumerate(system.components):
        yield ""
        yield f"-- {one_line(component.name)}"
        for state, edges in enumerate(component.edges):
            offered = [
                f"{internal[index] if event == INTERNAL else events[event]} -> {names[index]}_{after}"
                for event, after in edges
            ]
            if component.process and state in component.terminal:
                offered.append(f"ended -> {names[index]}_{state}")
            yield f"{names[index]}_{state} = {' [] '.join(offered) or 'STOP'}"
    yield ""
    alphabets = [
        [internal[index], *(["ended"] if component.process else [])]
        for index, component in enumerate(system.components)
    ]
    for event, name in zip(system.events, events, strict=True):
        for party in event.parties:
            alphabets[party].append(name)
    for index, (component, alphabet) in enumerate(zip(system.components, alphabets, strict=True)):
        yield f"component({index}) = {names[index]}_{component.initial}"
        yield f"alphabet({index}) = {{{', '.join(alphabet)}}}"
    yield ""
    yield f"SYSTEM = || n : {{0..{len(system.components) - 1}}} @ [alphabet(n)] component(n)"
    hidden = [*internal, *(name for event, name in zip(system.events, events, strict=True) if _is_inner(event.kind))]
    yield f"INNER = {{{', '.join(hidden)}}}"
    yield ""
    yield f"assert SYSTEM \\ {{{', '.join(internal)}}} :[deadlock free [F]]"
    yield "assert SYSTEM \\ INNER :[divergence free]"


def _is_inner(kind: str) -> bool:
    return kind not in {"external", "sample", "miss", "time"}
