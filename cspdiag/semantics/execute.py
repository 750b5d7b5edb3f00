"""The language's semantics as a program: slow, plain, and written from the text of the language reference alone.

It runs a network of the compiler without anything of the runtime or of the generated code, and says what must be communicated and when.
Processes are generators that yield requests (``requests``); channels know when two offers meet (``media``); the scheduler
(``scheduler``) chooses who runs and when time goes on.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

from cspdiag.network.ir.equations import ExternalBody
from cspdiag.network.ir.network import Environment, ExternalPort, Network, ProcessClass
from cspdiag.network.ir.walk import parts
from cspdiag.semantics import media
from cspdiag.semantics.instances import Place, ProcessInstance, Program, exception_name
from cspdiag.semantics.laws import FaultError, zero
from cspdiag.semantics.media import Medium
from cspdiag.semantics.scheduler import Scheduler
from cspdiag.semantics.trace import Ending, Execution
from cspdiag.semantics.values import Law, RaisedFaultError


class Plant:
    """The environment's system."""

    def __init__(self, environment: Environment) -> None:
        assert environment.system is not None
        assert not environment.drivers, "devices have no specification"
        self.step = environment.step
        self.law = Law(environment.system, {})
        self.inputs = {port.name: zero(port.type) for port in environment.system.ports if port.direction == "in"}
        self.now = 0
        self.signals: dict[str, Any] = {}

    def start(self) -> None:
        """Evaluate at time 0."""
        self.signals = self.law.evaluate(**self.inputs)

    def advance(self, now: int) -> None:
        """Integrate with the inputs held; discrete states step on the grid."""
        signals = self.law.evaluate(**self.inputs)
        self.law.advance(signals, (now - self.now) / 1e9, discrete=now % self.step == 0)
        self.now = now
        self.law.time = now / 1e9
        self.signals = self.law.evaluate(**self.inputs)

    def output(self, port: str) -> Any:
        """The present value of an output."""
        return self.signals[port]

    def give(self, port: str, value: Any) -> None:
        """The program's output has a new value."""
        self.inputs[port] = value


def execute(
    network: Network,
    environment: str | None = None,
    until: int | None = None,
    look: Callable[[Scheduler], None] | None = None,
    scheduler: Callable[..., Scheduler] = Scheduler,
) -> Execution:
    """Run a network in an environment (the first, where none is named) to its end, or to ``until`` nanoseconds.

    ``look`` is handed the state after each communication. ``scheduler`` makes the scheduler, where it is to be another one.
    """
    chosen = next((e for e in network.environments if environment in (None, e.name)), None)
    plant = None if chosen is None or chosen.system is None else Plant(chosen)
    world = scheduler(network.top, plant, timeouts=chosen is None or chosen.on_miss == "timeout")
    world.look = look
    ports: dict[Place, Medium] = {}
    for port in network.external_ports:
        medium = _external(world, port, plant)
        ports[port.name.partition("[")[0], port.index] = medium
        if isinstance(medium, media.ExternalInput):
            world.inputs.append(medium)
        elif isinstance(medium, media.SampledOutput):
            world.outputs.append(medium)
    cls = network.class_named(network.top)
    assert isinstance(cls, ProcessClass)
    sys.setrecursionlimit(max(sys.getrecursionlimit(), 20_000))
    try:
        program = ProcessInstance(Program(network, world), cls, network.top, dict(network.arguments), ports)
        if plant is not None:
            plant.start()
            for medium in world.inputs:
                medium.present = plant.output(medium.name.removeprefix(f"{network.top}."))
        ending = world.run(program.run(), until)
    except (RaisedFaultError, FaultError):
        ending = Ending("failed", world.now, "Fault")
    if world.failure is not None:
        ending = ending._replace(error=exception_name(world.failure))
    return Execution(world.trace, ending)


def waits(network: Network, environment: str | None, until: int | None, communication: int) -> tuple[str, ...]:
    """What each process waits for once so many communications have been made."""
    found: list[str] = []

    def look(world: Scheduler) -> None:
        if len(world.trace) == communication:
            found.extend(world.waits())

    execute(network, environment, until, look)
    return tuple(found)


def has_bodies_of_other_languages(network: Network, environment: str | None) -> bool:
    """Whether anything in the network, or the environment, is written by hand."""
    chosen = next((e for e in network.environments if environment in (None, e.name)), None)
    written = [part for part in parts((network.classes, chosen)) if isinstance(part, ExternalBody)]
    return bool(written)


def _external(world: Scheduler, port: ExternalPort, plant: Plant | None) -> Medium:
    name = f"{world.top}.{port.name}"
    if port.direction == "out":
        if port.period is None or port.immediate:
            return media.EventOutput(world, name)
        return media.SampledOutput(world, name, port.period)
    if port.period is None:
        return media.EventInput(world, name, port.kind == "broadcast")
    return media.SampledInput(world, name, port.period)
