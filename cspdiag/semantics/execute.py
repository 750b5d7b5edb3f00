"""Runs a whole network: what is communicated, and when.

Processes are generators that yield requests (``requests``, ``choice``); channels decide when two offers communicate
(``media``, ``outside``); the scheduler decides which process runs and when time advances.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable

from cspdiag.network.ir.external import external_bodies
from cspdiag.network.ir.network import ExternalPort, Network, ProcessClass
from cspdiag.semantics import outside
from cspdiag.semantics.environment import Plant
from cspdiag.semantics.equations.parameters import Change, Parameters
from cspdiag.semantics.instances import ProcessInstance, Program, exception_name
from cspdiag.semantics.media import Medium, Place
from cspdiag.semantics.observer import Observer
from cspdiag.semantics.scheduler import Scheduler
from cspdiag.semantics.trace import Ending, Execution
from cspdiag.semantics.values import FaultError, RaisedError


def execute(
    network: Network,
    environment: str | None = None,
    until: int | None = None,
    look: Callable[[Scheduler], None] | None = None,
    scheduler: Callable[..., Scheduler] = Scheduler,
    observer: Observer | None = None,
    changes: Iterable[Change] = (),
) -> Execution:
    """Run a network in an environment (the first one if none is named) to its end, or to ``until`` nanoseconds.

    «Scheduling and traces», «Environments and drivers»

    ``look`` is called with the state after each communication. ``scheduler`` makes the scheduler, if it is to be a
    different one. ``observer`` is notified of everything as it happens. ``changes`` are those of
    parameters of the program.
    """
    chosen = next((e for e in network.environments if environment in (None, e.name)), None)
    parameters = Parameters(network.parameters, changes)
    plant = None if chosen is None or chosen.system is None else Plant(chosen, parameters.cells)
    world = scheduler(network.top, plant, timeouts=chosen is None or chosen.on_miss == "timeout")
    world.look = look
    world.observer = observer
    world.parameters = parameters
    ports: dict[Place, Medium] = {}
    for port in network.external_ports:
        medium = _external(world, port, plant)
        ports[port.name.partition("[")[0], port.index] = medium
        if isinstance(medium, outside.ExternalInput):
            world.inputs.append(medium)
        elif isinstance(medium, outside.SampledOutput):
            world.outputs.append(medium)
    cls = network.class_named(network.top)
    assert isinstance(cls, ProcessClass)
    depth = sys.getrecursionlimit()
    sys.setrecursionlimit(max(depth, 20_000))
    failure: RaisedError | None = None
    try:
        arguments = {**dict(network.arguments), **{own: parameters.cells[name] for own, name in network.tunable}}
        program = ProcessInstance(Program(network, world), cls, network.top, arguments, ports)
        world.change_parameters(0)
        if plant is not None:
            plant.start()
            for medium in world.inputs:
                medium.present = plant.output(medium.name.removeprefix(f"{network.top}."))
        ending = world.run(program.run(), until)
    except FaultError as fault:
        ending = Ending("failed", world.now, "EnvironmentFailure")
        failure = fault
    finally:
        # Processes that still wait are dropped; that is not reported as their end.
        world.observer = None
        sys.setrecursionlimit(depth)
    if world.failure is not None:
        ending = ending._replace(error=exception_name(world.failure))
        failure = world.failure
    released = [] if chosen is None else _release(observer, network, ending.time)
    missed = [(port.name, port.missed) for port in world.inputs if isinstance(port, outside.SampledInput)]
    reason = "" if failure is None else str(failure)
    return Execution(world.trace, ending, released, missed, reason, failure)


def _release(observer: Observer | None, network: Network, time: int) -> list[tuple[str, object]]:
    """The outputs with the safe values that they are set to. «Processes and ports»"""
    released: list[tuple[str, object]] = []
    for port in network.external_ports:
        if port.direction == "out" and port.safe is not None:
            name = f"{network.top}.{port.name}"
            if observer is not None:
                observer.released(time, name, port.safe)
            released.append((name, port.safe))
    return released


def waits(network: Network, environment: str | None, until: int | None, communication: int) -> tuple[str, ...]:
    """What each process waits for after this number of communications. «Scheduling and traces»"""
    found: list[str] = []

    def look(world: Scheduler) -> None:
        if len(world.trace) == communication:
            found.extend(f"{who} waits {what}" for who, what in world.waits())

    execute(network, environment, until, look)
    return tuple(found)


def has_bodies_of_other_languages(network: Network, environment: str | None) -> bool:
    """Whether anything in the network, or the environment, is written by hand. «Environments and drivers»"""
    chosen = [item for item in network.environments if environment in (None, item.name)][:1]
    return any(True for _ in external_bodies(network.classes, chosen))


def _external(world: Scheduler, port: ExternalPort, plant: Plant | None) -> Medium:
    name = f"{world.top}.{port.name}"
    if port.direction == "out":
        if port.sampling is None or port.immediate:
            return outside.EventOutput(world, name)
        return outside.SampledOutput(world, name, port.sampling)
    if port.sampling is None:
        return outside.EventInput(world, name, port.kind == "broadcast")
    return outside.SampledInput(world, name, port.sampling)
