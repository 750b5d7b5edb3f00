"""Preference by the operating system and by the interpreter while a network runs against the clock.

The threads of ordinary programs cannot preempt it, its memory is not paged out, the garbage collector leaves alone what
existed before, and a thread that computes in Python gives way sooner. Whatever is not permitted is left as it is, and
reported. Other threads of the process are preferred, too: one that has lost the processor while it holds the lock of
the interpreter would delay the run.
"""

from __future__ import annotations

import gc
import os
import sys
import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from typing import Any, Final

_LEVEL: Final = 20
"""The priority within SCHED_RR of the thread that runs the network. Other threads are one below, so that they never
keep it from the processor, and the watch is one above. Interrupts that Linux handles in threads have 50.
"""
_SWITCH: Final = 0.0002
"""Seconds after which a thread that computes in Python gives way to another one that waits for the interpreter."""
_CURRENT, _FUTURE, _ON_FAULT = 1, 2, 4
"""Flags of mlockall. Pages that were never used stay absent until they are."""
_MAY_LOCK = 1 << 14
"""CAP_IPC_LOCK, in /proc/self/status."""
_TIMER_SLACK = 29
"""PR_SET_TIMERSLACK of prctl: by how many nanoseconds a wait may be prolonged. Zero restores what it was at first."""


class _Process:
    """What holds for the whole process: from when the first of several runs begins until the last has ended."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._runs = 0
        self._given = ExitStack()
        self._memory = ""

    @contextmanager
    def settled(self) -> Iterator[str]:
        """Settles it, and gives what is shown of locked memory."""
        counted = False
        try:
            with self._lock:
                self._runs += 1
                counted = True
                if self._runs == 1:
                    self._given.enter_context(_threads_give_way())
                    self._given.enter_context(_garbage_left_alone())
                    self._memory = self._given.enter_context(_memory_locked())
                    self._given.enter_context(_threads_restored())
            yield self._memory
        finally:
            if counted:
                with self._lock:
                    self._runs -= 1
                    if not self._runs:
                        self._given.close()


_process = _Process()


@contextmanager
def preferred() -> Iterator[str]:
    """Has the present thread preferred, and what exists by now settled, until the context is left. Gives what was
    granted, as it is shown.
    """
    with _process.settled() as memory, _scheduled_first() as scheduling:
        yield f"{scheduling}, {memory}"


@contextmanager
def _threads_give_way() -> Iterator[None]:
    interval = sys.getswitchinterval()
    try:
        sys.setswitchinterval(min(interval, _SWITCH))
        yield
    finally:
        sys.setswitchinterval(interval)


@contextmanager
def _garbage_left_alone() -> Iterator[None]:
    if gc.get_freeze_count():
        yield  # The program has done so itself.
        return
    try:
        gc.freeze()
        yield
    finally:
        gc.unfreeze()


@contextmanager
def _threads_restored() -> Iterator[None]:
    """Gives all threads back the classes that they have now; those that are started meanwhile get the ordinary one."""
    if not hasattr(os, "sched_setscheduler"):
        yield
        return
    before = {thread: _class_of(thread) for thread in _threads()}
    try:
        yield
    finally:
        for thread in _threads():
            _set_class(thread, *(before.get(thread) or (os.SCHED_OTHER, os.sched_param(0))))


@contextmanager
def _scheduled_first() -> Iterator[str]:
    if not hasattr(os, "sched_setscheduler"):
        yield "ordinary scheduling: this system has no SCHED_RR"
        return
    own = threading.get_native_id()
    policy, parameters = os.sched_getscheduler(own), os.sched_getparam(own)
    if policy != os.SCHED_OTHER and (policy, parameters.sched_priority) != (os.SCHED_RR, _LEVEL - 1):
        yield "scheduled as it was started"
        return
    try:
        # A handler of signals may raise something anywhere.
        if not _set_class(own, os.SCHED_RR, os.sched_param(_LEVEL)):
            with _precise_waits():
                yield "ordinary scheduling: SCHED_RR is not permitted"
            return
        for thread in _threads():
            if (_class_of(thread) or (None,))[0] == os.SCHED_OTHER:
                _set_class(thread, os.SCHED_RR, os.sched_param(_LEVEL - 1))
        yield "SCHED_RR"
    finally:
        _set_class(own, policy, parameters)


def _class_of(thread: int) -> tuple[int, Any] | None:
    """The scheduling class of a thread; None if it has ended."""
    with suppress(OSError):
        return os.sched_getscheduler(thread), os.sched_getparam(thread)
    return None


def _set_class(thread: int, policy: int, parameters: Any) -> bool:
    """Whether a thread has been given a scheduling class: it may have ended, and it may not be permitted."""
    try:
        os.sched_setscheduler(thread, policy, parameters)
    except OSError:
        return False
    return True


def shift_priority(by: int) -> None:
    """Moves the present thread up or down within its real-time class, if it has inherited one.

    A thread that has to interrupt another one must be able to preempt it: only a thread that runs can ask for the lock
    of the interpreter.
    """
    if not hasattr(os, "sched_setscheduler"):
        return
    own = threading.get_native_id()
    policy, level = os.sched_getscheduler(own), os.sched_getparam(own).sched_priority
    if policy in (os.SCHED_FIFO, os.SCHED_RR):
        _set_class(own, policy, os.sched_param(max(1, level + by)))


def _threads() -> list[int]:
    return [thread.native_id for thread in threading.enumerate() if thread.native_id is not None]


@contextmanager
def _precise_waits() -> Iterator[None]:
    """Linux prolongs the waits of ordinary threads by 50 microseconds, to wake several at once."""
    prctl = _function("prctl")
    if prctl is None:
        yield
        return
    try:
        prctl(_TIMER_SLACK, 1, 0, 0, 0)
        yield
    finally:
        prctl(_TIMER_SLACK, 0, 0, 0, 0)


@contextmanager
def _memory_locked() -> Iterator[str]:
    lock, unlock = _function("mlockall"), _function("munlockall")
    status = _status()
    if lock is None or unlock is None:
        yield "memory not locked: this system cannot"
        return
    if int(status.get("VmLck", "0 kB").split()[0]):
        yield "memory locked as it was"
        return
    # With a limit on locked memory, future allocations would fail as soon as it is reached.
    unlimited = int(status.get("CapEff", "0"), 16) & _MAY_LOCK or _has_no_limit()
    try:
        refused = lock((_CURRENT | _FUTURE if unlimited else _CURRENT) | _ON_FAULT)
        yield "memory not locked: not permitted" if refused else "memory locked"
    finally:
        unlock()


def _has_no_limit() -> bool:
    import resource

    return resource.getrlimit(resource.RLIMIT_MEMLOCK)[0] == resource.RLIM_INFINITY


def _status() -> dict[str, str]:
    """The lines of /proc/self/status by their names."""
    try:
        with open("/proc/self/status", encoding="ascii", errors="replace") as file:
            return {name: value.strip() for name, _, value in (line.partition(":") for line in file)}
    except OSError:
        return {}


def _function(name: str) -> Any:
    """A function of the C library, or None."""
    try:
        import ctypes

        return getattr(ctypes.CDLL(None), name, None)
    except (ImportError, OSError, TypeError):
        return None
