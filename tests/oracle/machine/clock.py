"""Time: instants at which something is due, samples with the sessions of their readers, events and latched outputs."""

from __future__ import annotations

from math import lcm

from tests.oracle.machine.channels import Channels
from tests.oracle.machine.horizon import horizon
from tests.oracle.machine.link import Linked
from tests.oracle.machine.policy import Policy
from tests.oracle.machine.state import Choice, Delay, Joint, Session, State, Thread, Tid
from tests.oracle.machine.values import NOW, zero
from tests.oracle.programs.tree import Port, Value


class MissedSampleError(Exception):
    """A sample that was missed; raised at the next read."""


def _is_tick(now: int, ticks: tuple[int, int] | None) -> bool:
    """Whether an instant, later than 0, is an offset after a multiple of a period."""
    return ticks is not None and now % ticks[0] == ticks[1]


class Clock:
    def __init__(self, linked: Linked, policy: Policy, channels: Channels) -> None:
        self.linked = linked
        self.policy = policy
        self.channels = channels
        program = linked.program
        self.ticks = sorted({port.ticks for port in program.ports if port.ticks})
        events = any(port.input and not port.period for port in program.ports)
        self.made: list[tuple[str, Value]] = []  # at external ports, since the last clear: inputs when they are taken
        self.written: list[tuple[str, Value]] = []  # to external outputs, since the last clear
        self.grid = program.step if events else None
        self.cycle = [*self.ticks, *([(self.grid, 0)] if self.grid else [])]
        self.whole = lcm(*(period for period, _ in self.cycle)) if self.cycle else 1
        self.horizon = horizon(program)
        self.last = max((begin for port in program.ports for begin, _ in port.values), default=0)

    def start(self, st: State) -> None:
        for port in self.linked.program.ports:
            if port.input and not port.period:
                st.offered[port.name] = port.values[0][1] if port.values else zero(port.type)

    # ---- instants ----

    def dues(self, st: State) -> list[int]:
        """When the delays and time-outs that have begun are due."""
        found = []
        for thread in st.threads.values():
            if isinstance(thread.wait, Delay):
                found.append(thread.wait.due)
            if isinstance(thread.wait, Choice):
                found += [offer.due for offer in thread.wait.offers if offer.kind == "after"]
            for frame in thread.stack:
                if frame.offer is not None and frame.offer.kind == "after" and frame.status == "armed":
                    found.append(frame.offer.due)
        return found

    def next_instant(self, st: State) -> int | None:
        times = [due for due in self.dues(st) if due > st.now] + [
            ((st.now - offset) // period + 1) * period + offset for period, offset in self.cycle
        ]
        return min(times, default=None)

    def instant(self, st: State) -> None:
        """Everything that happens at this instant before any process runs."""
        st.variables[NOW] = st.now
        ports = self.linked.program.ports
        for port in ports:
            if port.input and _is_tick(st.now, port.ticks):
                self._sample(st, port)
            elif port.input and not port.period and self.grid is not None and st.now % self.grid == 0:
                self._offer(st, port)
        for port in ports:
            if not port.input and _is_tick(st.now, port.ticks) and port.name in st.latches:
                self.policy.passed(port.name, st.latches.pop(port.name), external=True)
        self._due(st)

    def _due(self, st: State) -> None:
        found: list[tuple[int, Thread, int | None]] = []
        for thread in st.threads.values():
            if isinstance(thread.wait, Delay) and thread.wait.due <= st.now:
                found.append((thread.wait.seq, thread, None))
            if isinstance(thread.wait, Choice):
                offers = [offer for offer in thread.wait.offers if offer.kind == "after" and offer.due == st.now]
                found += [(offer.seq, thread, None) for offer in offers]
            for depth, frame in enumerate(thread.stack):
                if frame.offer is None or frame.offer.kind != "after" or frame.status != "armed":
                    continue
                if frame.offer.due <= st.now:
                    found.append((frame.offer.seq, thread, depth))
        for _, thread, place in sorted(found, key=lambda each: each[0]):
            if place is not None:
                if place < len(thread.stack) and thread.stack[place].status == "armed":
                    self.channels.fire(st, thread, place)
            elif thread.wait is not None:
                self.channels.ready(st, thread)

    def _sample(self, st: State, port: Port) -> None:
        st.samples[port.name] = self.policy.sample(port, st.now)
        for key, session in st.sessions.items():
            if key[1] == port.name:
                st.sessions[key] = Session(fresh=True, missed=session.missed or session.fresh, ticked=True)
                st.missed = st.missed or session.fresh
        self._wake(st, port.name)

    def _offer(self, st: State, port: Port) -> None:
        value = self.policy.event(port, st.now, st.offered[port.name])
        if value is not None:
            self.bring(st, port, value)

    def bring(self, st: State, port: Port, value: Value) -> None:
        """The environment offers an event."""
        st.offered[port.name] = value
        st.events[port.name] = value
        self._wake(st, port.name)

    def _wake(self, st: State, name: str) -> None:
        """Wake the threads that wait for an external input, in the order of the program."""
        for tid in sorted(st.threads):
            thread = st.threads[tid]
            match thread.wait:
                case Joint(ops) if any(op.channel == name and op.end == "?" and not op.done for op in ops):
                    self.channels.ready(st, thread)
                case Choice(_, offers) if any(
                    offer.channel == name and offer.kind in ("read", "ready") for offer in offers
                ):
                    self.channels.ready(st, thread)
            for depth, frame in enumerate(thread.stack):
                if frame.offer is None or frame.offer.kind not in ("read", "ready") or frame.status != "armed":
                    continue
                if frame.offer.channel == name:
                    self.channels.fire(st, thread, depth)

    # ---- external ports ----

    def follow(self, st: State, me: Thread, name: str, number: int) -> None:
        """Begin the session of a sampled input, unless it has begun."""
        key = (self._process(me.tid), name, number)
        if key not in st.sessions:
            st.sessions[key] = Session(fresh=self._follows(st, me, name), missed=False, ticked=False)

    def _follows(self, st: State, me: Thread, name: str) -> bool:
        """Whether the process has a session for the period and offset of a port, in any part, that began before the
        latest tick.
        """
        ticks = self.linked.ports[name].ticks
        same = {port.name for port in self.linked.program.ports if port.input and port.ticks == ticks}
        return any(
            session.ticked and other in same and process == self._process(me.tid)
            for (process, other, _), session in st.sessions.items()
        )

    def _process(self, tid: Tid) -> int:
        """The process that a thread belongs to: a branch of the outermost parallel printed as one, or the outermost
        process.
        """
        return tid[0][1] if tid and tid[0][1] in self.linked.program.boxed else -1

    def close(self, st: State, process: Thread) -> None:
        """End the sessions of a process that has ended."""
        for key in list(st.sessions):
            if key[0] == self._process(process.tid):
                del st.sessions[key]

    def available(self, st: State, me: Thread, name: str, number: int) -> bool:
        port = self.linked.ports[name]
        if port.period is None:
            if name not in st.events:
                value = self.policy.before(port)
                if value is not None:
                    self.bring(st, port, value)
            return name in st.events
        session = st.sessions.get((self._process(me.tid), name, number))
        return self._follows(st, me, name) if session is None else session.fresh or session.missed

    def read(self, st: State, me: Thread, name: str, number: int) -> Value:
        """Take what is available."""
        port = self.linked.ports[name]
        if port.period is None:
            value = st.events.pop(name)
        else:
            key = (self._process(me.tid), name, number)
            session = st.sessions[key]
            if session.missed:
                st.sessions[key] = session._replace(missed=False)
                st.timeout = True
                raise MissedSampleError
            st.sessions[key] = session._replace(fresh=False)
            value = st.samples[name]
        self.made.append((name, value))
        self.policy.passed(name, value, external=True)
        return value

    def write(self, st: State, name: str, value: Value) -> None:
        port = self.linked.ports[name]
        self.written.append((name, value))
        self.made.append((name, value))
        if port.period is not None and not port.immediate:
            st.latches[name] = value
        else:
            self.policy.passed(name, value, external=True)

    def elapse(self, st: State, duration: int) -> None:
        """A law computes for this duration; what is due meanwhile happens, but no thread runs."""
        end = st.now + duration
        while (instant := self.next_instant(st)) is not None and instant <= end and instant > st.now:
            st.now = instant
            self.instant(st)
        st.now = st.variables[NOW] = end
