"""Whether the processes that a trace leaves stuck are so in a replay."""

from __future__ import annotations

from collections.abc import Callable, Container

from cspdiag.verify.decisions import Decisions
from cspdiag.verify.replay.gates import Conductor, Gate
from cspdiag.verify.runs.names import belongs
from cspdiag.verify.runs.trace import DivergenceError, Trace


class Standstill:
    """The end of a replay; ``ports`` are those of the program, ``settle`` lets every process continue to a gate."""

    def __init__(
        self,
        conductor: Conductor,
        trace: Trace,
        decisions: Decisions,
        ports: Container[str],
        settle: Callable[[], None],
    ) -> None:
        self._conductor = conductor
        self._trace = trace
        self._decisions = decisions
        self._ports = ports
        self._settle = settle

    def end_silently(self) -> None:
        """Lets processes take guards that are always ready, also those of interrupts: transition systems leave out
        steps that make no difference.
        """
        for interruption in list(self._conductor.interruptions):
            if interruption in self._conductor.interruptions and interruption.options[0].action == "skip":
                interruption.fire()
                self._settle()
        gates = [
            gate for gate in self._conductor.halted.values() if any(option.action == "skip" for option in gate.options)
        ]
        for gate in gates:
            silent = [option for option in gate.options if option.action == "skip"]
            if self._trace.failure == "deadlock" or len(silent) == len(gate.options):
                chosen = silent[self._decisions.choose(len(silent))]
                self._conductor.release(gate, chosen)
                self._settle()

    def _is_stuck(self, gate: Gate) -> bool:
        """Whether a process never continues according to the trace; its parallel branches are distinguished by where
        they wait.
        """
        waits = {option.channel for option in gate.options if option.channel}
        return any(belongs(gate.path, path) and waits & channels for path, channels in self._trace.stuck)

    def _require_stuck(self, stuck: list[Gate]) -> None:
        """Raises DivergenceError if a process among ``stuck`` can continue by itself, with the environment, or with
        those that continue.
        """
        moving = [gate for gate in self._conductor.halted.values() if gate not in stuck]
        offered = {(option.action, option.channel) for gate in moving for option in gate.options}
        for gate in stuck:
            for option in gate.options:
                can_happen = option.action in {"wait", "after", "skip"} or option.channel in self._ports
                opposite = "read" if option.action == "write" else "write"
                if can_happen or (opposite, option.channel) in offered:
                    way = f" with `{option.channel}`" if option.channel else ""
                    raise DivergenceError(f"`{self._conductor.names.called(gate.task)}` can still continue{way}")

    def try_to_continue(self) -> None:
        """Lets all processes through their gates. Raises DivergenceError if one that is to be stuck can continue."""
        stuck = [
            gate
            for gate in self._conductor.halted.values()
            if self._trace.failure == "deadlock" or self._is_stuck(gate)
        ]
        self._require_stuck(stuck)
        self._conductor.let_all_through()
        for gate in stuck:
            self._conductor.release(gate, None)
        self._settle()
