"""The functions of an instance of an FMU, the same for both versions of FMI. fmpy loads the library and calls it."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from typing import Any

from cspdiag.fmu.description import FmuDescription, FmuError, FmuVariable, read_description
from cspdiag.fmu.ends import present, watch_ends
from cspdiag.fmu.extracted import binary, extracted

Value = float | int | bool
MOST_UPDATES = 1000
"""Updates of discrete states at one event, after which the FMU is considered not to get any further."""


class Library:
    """One instance. All methods raise FmuError where the FMU returns an error, with its messages."""

    def __init__(self, path: str, *, model_exchange: bool) -> None:
        self.path = path
        self.description: FmuDescription = read_description(path)
        self._model_exchange = model_exchange
        self._message = ""
        self._is_new = self.description.version == "3.0"
        identifier = self.description.model_exchange if model_exchange else self.description.co_simulation
        assert identifier is not None
        binary(path, self.description, identifier)
        self._fmu = self._instance(extracted(path), identifier)
        count, indicators = self.description.states, self.description.indicators
        from ctypes import c_double

        self._states, self._slopes = (c_double * count)(), (c_double * count)()
        self._indicators = (c_double * indicators)()

    def _instance(self, folder: str, identifier: str) -> Any:
        try:
            from fmpy.fmi2 import FMU2Model, FMU2Slave
            from fmpy.fmi3 import FMU3Model, FMU3Slave
        except ImportError:
            raise FmuError(f"{self.path} needs fmpy, which is not installed", "pip install cspdiag[fmi]") from None
        classes = (FMU3Slave, FMU3Model) if self._is_new else (FMU2Slave, FMU2Model)
        class_ = classes[1 if self._model_exchange else 0]
        facts = {
            "guid": self.description.token,
            "modelIdentifier": identifier,
            "unzipDirectory": folder,
            "instanceName": self.description.name,
        }
        folder_of_process = os.getcwd()
        watch_ends()
        present.path, present.doing = self.path, "before the run"
        try:
            fmu = class_(**facts)
            # With messages: there are FMUs that say only then why they fail.
            if self._is_new:
                fmu.instantiate(loggingOn=True, logMessage=lambda _, *message: self._hear(*message))
            else:
                self._callbacks = _callbacks(lambda _, name, *message: self._hear(*message))
                fmu.instantiate(loggingOn=True, callbacks=self._callbacks)
        except Exception as problem:
            os.chdir(folder_of_process)  # fmpy loads a binary from its own folder, and stays there if that fails.
            raise FmuError(
                self._with_message(f"{self.path} cannot be loaded: {problem}"),
                "its binary is damaged, or needs a library that is not here: export it again, or compile its sources, "
                "if it has some: fmpy compile",
            ) from None
        finally:
            present.path = ""
        return fmu

    def _hear(self, status: int, category: bytes | None, text: bytes | None) -> None:
        if status != _OK:
            self._message = " ".join((text or b"").decode("utf-8", "replace").split())

    def _with_message(self, text: str) -> str:
        message, self._message = self._message, ""
        return f"{text}: {message}" if message else text

    def _call(self, doing: str, function: Callable[..., Any], *arguments: Any) -> Any:
        from fmpy.fmi1 import FMICallException

        present.path, present.doing = self.path, doing
        try:
            result = function(*arguments)
        except FMICallException as problem:
            text = f"{self.path} returned {_STATUS.get(problem.status, problem.status)} in {problem.function}, {doing}"
            raise FmuError(self._with_message(text), "") from None
        finally:
            present.path = ""
        self._message = ""
        return result

    # ---- Life

    def initialize(self, start: float, given: Sequence[tuple[FmuVariable, Value]]) -> None:
        """Initializes the instance with values of parameters and inputs."""
        doing = "at the start"
        if self._is_new:
            self._give(doing, [item for item in given if item[0].causality == "parameter"])
            self._call(doing, lambda: self._fmu.enterInitializationMode(startTime=start))
        else:
            self._call(doing, lambda: self._fmu.setupExperiment(startTime=start))
            self._give(doing, [item for item in given if item[0].causality == "parameter"])
            self._call(doing, self._fmu.enterInitializationMode)
        self._give(doing, [item for item in given if item[0].causality != "parameter"])
        self._call(doing, self._fmu.exitInitializationMode)

    def free(self) -> None:
        """Ends the instance."""
        self._fmu.freeInstance()

    # ---- Values

    def give(self, time: float, given: Sequence[tuple[FmuVariable, Value]]) -> None:
        """Sets variables."""
        self._give(f"at {time:.9g} s", given)

    def _give(self, doing: str, given: Sequence[tuple[FmuVariable, Value]]) -> None:
        groups: dict[str, tuple[list[int], list[Value]]] = {}
        for variable, value in given:
            references, values = groups.setdefault(self._kind(variable), ([], []))
            references.append(variable.reference)
            values.append(value)
        for kind, (references, values) in groups.items():
            self._call(doing, getattr(self._fmu, f"set{kind}"), references, values)

    def take(self, time: float, variables: Sequence[FmuVariable]) -> list[Value]:
        """Gets variables."""
        doing = f"at {time:.9g} s"
        positions: dict[str, list[int]] = {}
        for position, variable in enumerate(variables):
            positions.setdefault(self._kind(variable), []).append(position)
        taken: list[Value] = [0.0] * len(variables)
        for kind, places in positions.items():
            references = [variables[place].reference for place in places]
            values = self._call(doing, getattr(self._fmu, f"get{kind}"), references)
            for place, value in zip(places, values, strict=True):
                taken[place] = value
        return taken

    def _kind(self, variable: FmuVariable) -> str:
        if variable.type == "Enumeration":
            return "Int64" if self._is_new else "Integer"
        return variable.type

    # ---- Co-simulation

    def step(self, time: float, length: float) -> None:
        """A step from ``time``."""
        end = time + length
        done = self._call(f"in the step from {time:.9g} s to {end:.9g} s", self._fmu.doStep, time, length)
        if self._is_new:
            _, terminates, _, _ = done
            self._refuse_end(terminates, end)

    def _refuse_end(self, terminates: object, time: float) -> None:
        """An environment continues as long as the run does."""
        if terminates:
            raise FmuError(self._with_message(f"{self.path} has ended the simulation at {time:.9g} s"), "")

    # ---- Model exchange

    def update(self, time: float) -> float | None:
        """Updates the discrete states in event mode, until nothing changes; returns the time of the next event."""
        doing = f"at the event of {time:.9g} s"
        update = self._fmu.updateDiscreteStates if self._is_new else self._fmu.newDiscreteStates
        for _ in range(MOST_UPDATES):
            again, terminates, _, _, has_next, next_event = self._call(doing, update)
            self._refuse_end(terminates, time)
            if not again:
                return float(next_event) if has_next else None
        raise FmuError(
            f"{self.path} has updated its discrete states {MOST_UPDATES} times {doing}", "it does not get any further"
        )

    def enter_event_mode(self, time: float) -> None:
        """From now on the event is handled."""
        self._call(f"at the event of {time:.9g} s", self._fmu.enterEventMode)

    def enter_continuous_time_mode(self, time: float) -> None:
        """From now on states are integrated."""
        self._call(f"at {time:.9g} s", self._fmu.enterContinuousTimeMode)

    def step_completed(self, time: float) -> bool:
        """Whether an event is to be handled after a step of the integrator."""
        enters, terminates = self._call(f"at {time:.9g} s", self._fmu.completedIntegratorStep)
        self._refuse_end(terminates, time)
        return bool(enters)

    def states(self) -> list[float]:
        """The continuous states."""
        if self._states:
            self._call("reading states", self._fmu.getContinuousStates, self._states, len(self._states))
        return list(self._states)

    def go_to(self, time: float, states: Sequence[float]) -> None:
        """Sets time and continuous states."""
        doing = f"at {time:.9g} s"
        self._call(doing, self._fmu.setTime, time)
        if self._states:
            self._states[:] = list(states)
            self._call(doing, self._fmu.setContinuousStates, self._states, len(self._states))

    def slopes(self, time: float, states: Sequence[float]) -> list[float]:
        """The derivatives of the states."""
        self.go_to(time, states)
        if self._slopes:
            get = self._fmu.getContinuousStateDerivatives if self._is_new else self._fmu.getDerivatives
            self._call(f"at {time:.9g} s", get, self._slopes, len(self._slopes))
        return list(self._slopes)

    def signs(self, time: float) -> list[bool]:
        """Which event indicators are positive."""
        if self._indicators:
            get = self._fmu.getEventIndicators
            self._call(f"at {time:.9g} s", get, self._indicators, len(self._indicators))
        return [value > 0.0 for value in self._indicators]


_OK = 0
_STATUS = {2: "discard", 3: "an error", 4: "a fatal error"}


def _callbacks(logged: Callable[..., None]) -> Any:
    from fmpy.fmi2 import (
        calloc,
        fmi2CallbackAllocateMemoryTYPE,
        fmi2CallbackFreeMemoryTYPE,
        fmi2CallbackFunctions,
        fmi2CallbackLoggerTYPE,
        free,
    )

    made = fmi2CallbackFunctions()
    made.logger = fmi2CallbackLoggerTYPE(logged)
    made.allocateMemory = fmi2CallbackAllocateMemoryTYPE(calloc)
    made.freeMemory = fmi2CallbackFreeMemoryTYPE(free)
    return made
