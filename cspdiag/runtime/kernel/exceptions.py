"""Exceptions of CSP programs.

A process that ends unsuccessfully raises a ``ProcessError``: its siblings in a parallel are cancelled at their next
communication, and then the exception propagates until a ``try`` catches it or the program ends.
"""

from __future__ import annotations

import os
import sys


class Place(str):
    """Where an exception was raised: the ``process`` by its path, and the ``statement`` in the text of the program
    (``laws.csp:12``), if it is known.
    """

    process: str
    statement: str | None

    def __new__(cls, process: str, statement: str | None = None, by_hand: str | None = None) -> Place:
        """The text is ``process (statement), at by_hand``; the last is a line written by hand (``law.py:3``)."""
        at = "" if by_hand is None else f", at {by_hand}"
        place = super().__new__(cls, f"{process}{'' if statement is None else f' ({statement})'}{at}")
        place.process = process
        place.statement = statement
        return place


class ProcessError(Exception):
    """A process ended unsuccessfully; base class of the exceptions that a program declares.

    ``place`` names the process in which it was raised and the source line; it is filled in when the exception leaves
    that process.
    """

    place: Place | None = None


class Timeout(ProcessError):  # noqa: N818 - the name that the language gives it
    """A sample was overwritten before it had been taken: a missed deadline."""

    is_of_link = False
    """Whether instead another host, for which the process waits, is silent."""


class Fault(ProcessError):  # noqa: N818 - the name that the language gives it
    """A value that does not exist: overflow, division by zero, a NaN written to an actuator."""

    def __init__(self, message: str, place: Place | None = None) -> None:
        super().__init__(message)
        self.message = message
        self.place = place

    def __str__(self) -> str:
        return self.message if self.place is None else f"{self.message}, in {self.place}"


def fault_of(error: ArithmeticError, place: Place | None) -> Fault:
    """The fault that an error of Python's arithmetic means."""
    return Fault("division by zero" if isinstance(error, ZeroDivisionError) else str(error), place)


def text_of(error: BaseException) -> str:
    """The text of an exception. If that cannot be made, another text: outputs must be released all the same."""
    try:
        return str(error)
    except BaseException as failed:
        return f"(its text cannot be made: {type(failed).__name__})"


def kind_and_text(error: BaseException) -> str:
    """The class of an exception and its text, if any."""
    name, text = type(error).__name__, text_of(error)
    return f"{name}: {text}" if text else name


class RunEnded(BaseException):
    """Ends a run at once; no process can catch it."""


def run_is_ended() -> bool:
    """Whether the exception being handled ends the run; the processes that it leaves were then still running."""
    return isinstance(sys.exception(), RunEnded)


class RunFailed(RunEnded):
    """Ends a run at once, unsuccessfully, with ``error``."""

    def __init__(self, error: Exception) -> None:
        super().__init__(error)
        self.error = error


class OutsideError(Exception):
    """What ended a run is not the program itself; the text says it in a sentence."""


class DriverError(OutsideError):
    """A driver failed at ``open``, ``read``, ``write`` or ``close``; the run ends with its outputs released."""

    def __init__(self, driver: str, port: str, operation: str, cause: BaseException, at: str | None = None) -> None:
        where = "" if at is None else f", at {at}"
        super().__init__(f"driver {driver} failed to {operation} at port {port}: {kind_and_text(cause)}{where}")
        self.driver = driver
        self.port = port
        self.operation = operation


class EnvironmentFailure(OutsideError):  # noqa: N818 - not a fault of the program
    """The plant or the operator of an environment failed; the run ends with its outputs released."""

    def __init__(self, environment: str, cause: BaseException, place: str | None, at: str | None = None) -> None:
        where = ("" if place is None else f", in {place}") + ("" if at is None else f", at {at}")
        super().__init__(f"the environment {environment} failed: {kind_and_text(cause)}{where}")


class HandlerError(OutsideError):
    """A handler of a signal that does not belong to the runtime has raised an exception; the run ends with its outputs
    released.
    """

    def __init__(self, signal: str, handler: object, cause: BaseException) -> None:
        code = getattr(handler, "__code__", None)
        where = "" if code is None else f" ({code.co_name}, {os.path.basename(code.co_filename)}:{code.co_firstlineno})"
        super().__init__(f"the handler of {signal}{where} raised {kind_and_text(cause)}")


class HangError(OutsideError):
    """A step of the program does not end; the run ends with its outputs released."""


class ChannelMisuse(Exception):  # noqa: N818 - it says what was done
    """Two processes read, or two write, at the same time on a channel that allows one."""


class PartnerLost(OutsideError):  # noqa: N818 - it says what has happened
    """Another host has ended its part of the program, or is silent; the run ends with its outputs released."""


class Deadlock(Exception):  # noqa: N818 - the field's term
    """No process can ever continue; raised by ``Outcome.raise_if_unsuccessful``."""


class Cancelled(BaseException):
    """Ends a process at its next communication, because a sibling failed or an interrupt occurred.

    Not an ``Exception``, so handlers for errors do not catch it. In a process that catches it all the same, it is
    raised again at the following communication.
    """


ANOTHER_BRANCH = "another parallel branch ended with"
"""How a note begins that is only for users of the exception in Python; the text that a run prints is the same on every
target.
"""


def described(error: BaseException) -> str:
    """The exception in the words of the program: its name, unless it is not of the program, its text, and where it was
    raised.
    """
    text = text_of(error)
    if isinstance(error, OutsideError):
        return text
    place = getattr(error, "place", None)
    noted = [note for note in getattr(error, "__notes__", []) if not note.startswith(ANOTHER_BRANCH)]
    notes = [f"in {place}"] if place is not None and place not in text else noted
    return ", ".join([kind_and_text(error), *notes])
