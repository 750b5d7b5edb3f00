"""Rendezvous, alternatives and delays as the language reference defines them, as simply as possible.

A program is a list of operations for every process: ``("write", channel, value)``, ``("read", channel)``, ``("wait",
duration)`` or ``("select", guards, prioritized)`` with guards ``("in", channel)`` and ``("out", channel, value)``.
"""

from __future__ import annotations

from collections import deque
from typing import Any

Operation = tuple[Any, ...]
Entry = tuple[int, str, int]


class Interpreter:
    def __init__(self, programs: list[list[Operation]]) -> None:
        self.programs = programs
        self.position = [0] * len(programs)
        self.waiting: dict[int, Operation] = {}
        self.ready = deque(range(len(programs)))
        self.last = [[-1] * len(program) for program in programs]
        self.timers: list[tuple[int, int, int]] = []
        self.now = 0
        self.trace: list[Entry] = []

    def run(self) -> tuple[list[Entry], bool]:
        """The trace, and whether all processes ended."""
        while True:
            while self.ready:
                self.run_process(self.ready.popleft())
            if not self.timers:
                break
            self.now = min(self.timers)[0]
            due = [timer for timer in sorted(self.timers, key=lambda timer: timer[1]) if timer[0] == self.now]
            self.timers = [timer for timer in self.timers if timer[0] != self.now]
            self.ready.extend(process for _, _, process in due)
        return self.trace, all(p == len(program) for p, program in zip(self.position, self.programs, strict=True))

    def run_process(self, process: int) -> None:
        while self.position[process] < len(self.programs[process]):
            operation = self.programs[process][self.position[process]]
            if operation[0] == "wait":
                self.position[process] += 1
                self.timers.append((self.now + operation[1], len(self.trace) * 1000 + self.serial(), process))
                return
            if not self.communicate(process, operation):
                return

    _serial = 0

    def serial(self) -> int:
        self._serial += 1
        return self._serial * 1_000_000

    def communicate(self, process: int, operation: Operation) -> bool:
        """Make the communication if a partner waits; otherwise wait."""
        if operation[0] == "select":
            self.waiting.pop(process, None)
            guards = operation[1]
            possible = [k for k, guard in enumerate(guards) if self.partners(process, guard, alternatives=True)]
            if not possible:
                self.waiting[process] = operation
                return False
            last = -1 if operation[2] else self.last[process][self.position[process]]
            index = next((k for k in possible if k > last), possible[0])
            self.last[process][self.position[process]] = index
            self.meet(process, guards[index])
            return True
        guard = ("out", *operation[1:]) if operation[0] == "write" else ("in", operation[1])
        if self.partners(process, guard, alternatives=False):
            self.meet(process, guard)
            return True
        self.waiting[process] = operation
        for other, (_, index) in self.offers(process, guard):
            if index is not None and other not in self.ready:
                self.ready.append(other)
        return False

    def offers(self, process: int, guard: Operation) -> list[tuple[int, tuple[Operation, int | None]]]:
        """The processes that wait at the other end: plainly (index None) or with a guard."""
        direction = "in" if guard[0] == "out" else "out"
        found: list[tuple[int, tuple[Operation, int | None]]] = []
        for other, operation in self.waiting.items():
            if other == process:
                continue
            if operation[0] == "select":
                for index, offered in enumerate(operation[1]):
                    if offered[0] == direction and offered[1] == guard[1]:
                        found.append((other, (offered, index)))
            elif (operation[0] == "write") == (direction == "out") and operation[1] == guard[1]:
                found.append((other, ((direction, *operation[1:]), None)))
        return found

    def partners(self, process: int, guard: Operation, *, alternatives: bool) -> list[Any]:
        return [entry for entry in self.offers(process, guard) if alternatives or entry[1][1] is None]

    def meet(self, process: int, guard: Operation) -> None:
        candidates = self.partners(process, guard, alternatives=True)
        other, (offered, index) = next((entry for entry in candidates if entry[1][1] is None), candidates[0])
        value = guard[2] if guard[0] == "out" else offered[2]
        self.trace.append((self.now, f"c{guard[1]}", value))
        del self.waiting[other]
        if index is not None:
            self.last[other][self.position[other]] = index
        self.position[other] += 1
        self.position[process] += 1
        if other not in self.ready:
            self.ready.append(other)
