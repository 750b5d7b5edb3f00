"""The one run of a program in the environment that is printed with it: the trace that every implementation
must have.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from tests.oracle.machine.link import link
from tests.oracle.machine.machine import Machine
from tests.oracle.machine.policy import Unwitnessed
from tests.oracle.programs.tree import Program, Value

Communication = tuple[int, str, Value]


class _Listening(Unwitnessed):
    def __init__(self) -> None:
        self.made: list[tuple[str, Value, bool]] = []

    def passed(self, channel: str, value: Value, external: bool) -> None:
        self.made.append((channel, value, external))


@dataclass
class PageRun:
    trace: list[Communication] = field(default_factory=list)
    ending: str = ""  # terminated, deadlock, limit, too long, or the name of an exception
    time: int = 0
    missed: bool = False
    timeout: bool = False


def page_run(program: Program, until: int, steps: int = 20000) -> PageRun:
    """Run up to and including an instant; `too long` if more steps than the limit are needed."""
    listening = _Listening()
    machine = Machine(link(program), listening)
    st = machine.start()
    run = PageRun()
    for _ in range(steps):
        if st.ended is not None:
            run.ending = st.ended
            break
        candidates = machine.candidates(st)
        if candidates:
            machine.run(st, candidates[0])
        else:
            instant = machine.clock.next_instant(st)
            if instant is None or not machine.more_follows(st):
                run.ending = "deadlock"
                break
            if instant > until:
                run.ending = "limit"
                break
            st.now = instant
            machine.clock.instant(st)
        run.trace += [(st.now, channel, value) for channel, value, _ in listening.made]
        listening.made.clear()
    else:
        run.ending = "too long"
    run.time, run.missed, run.timeout = st.now, st.missed, st.timeout
    return run
