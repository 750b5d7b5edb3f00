"""What a program does in a real run, as a script to be followed: a replay must be able to do it again."""

from __future__ import annotations

from typing import Any

from cspdiag import pipeline
from cspdiag.base.sources import read_source
from cspdiag.network.ir.network import Network
from cspdiag.proofs.verdict import Limits
from cspdiag.runtime.kernel.party import Party
from cspdiag.runtime.kernel.policy import Option, Policy
from cspdiag.runtime.kernel.scheduler import present
from cspdiag.simulate.run.package import LoadedPackage
from cspdiag.verify.guided.guided import Guided
from cspdiag.verify.guided.result import GuidedRun
from cspdiag.verify.guided.script import Passed
from cspdiag.verify.runs.task_names import TaskNames, path_of, task_of
from cspdiag.verify.runs.trace import Trace, TraceStep


class _Record(Policy):
    """Records the first steps of a run, and changes nothing. ``visible`` are those at ports, in order."""

    def __init__(self, network: Network, most: int) -> None:
        self.entries: list[Passed] = []
        self.visible: list[TraceStep] = []
        self._ports = {f"{network.top}.{port.name}": port.direction for port in network.external_ports}
        self._broadcasts: set[str] = set()
        self._most = most
        self._names = TaskNames()

    def did(self, task: Party, option: Option) -> None:
        if not option.channel:
            self._note(task, option.action, "", option.index)

    def took_part(self, party: Party, action: str, channel: str) -> None:
        if action == "write":
            self._broadcasts.add(channel)
        self._note(party, action, channel)

    def wrote(self, party: Party, channel: str, value: Any) -> None:
        self._see(channel)
        self._note(party, "write", channel)

    def observe(self, channel: str, value: Any, writer: Party | None, reader: Party | None) -> None:
        if self._ports.get(channel) == "out":
            return
        self._see(channel)
        if writer is not None and channel not in self._broadcasts:
            self._note(writer, "write", channel)
        if reader is not None:
            self._note(reader, "read", channel, 0, value if writer is None else None)

    def _see(self, channel: str) -> None:
        if channel in self._ports and len(self.entries) < self._most:
            self.visible.append(TraceStep("external", channel, None, ()))

    def _note(self, party: Party, action: str, channel: str, index: int = 0, value: Any = None) -> None:
        if len(self.entries) < self._most:
            task = task_of(party)
            self.entries.append(Passed(self._names.key(task), path_of(task), action, channel, index, value=value))


class _Observed:
    """An environment, with a record of what happens in it."""

    def __init__(self, environment: Any, record: _Record) -> None:
        self._environment = environment
        self._record = record
        self.step = environment.step
        self.drivers = environment.drivers

    def start(self) -> None:
        present().observe = self._record.observe
        self._environment.start()

    def advance(self, now: int) -> None:
        self._environment.advance(now)


def followed(network: Network, until: int, most: int) -> tuple[list[Passed], GuidedRun]:
    """The first ``most`` steps of a network in its first environment, and a guided run that has to take the same steps,
    with nothing else at its ports.
    """
    files = pipeline.generate(network, read_source, level=0)
    package = LoadedPackage(network.name, files)
    record = _Record(network, most)
    try:
        chosen = network.environments[0]
        environment = package.module("environments").ENVIRONMENTS[chosen.name]()
        running = package.module("network").build(environment.drivers)
        running.run(_Observed(environment, record), until=until, on_miss=chosen.on_miss, policy=record)
        trace = Trace(network.top, {}, "", "refinement", tuple(record.visible), (), (), exact=True)
        guided = Guided(network, package, Limits())
        return record.entries, guided.follow(record.entries, trace, 0, ends=False)
    finally:
        package.close()
