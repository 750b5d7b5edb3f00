"""A small simulator of two FMUs, on fmpy: a program and its environment exchange values between steps."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import fmpy
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave

Values = dict[str, Any]


class Instance:
    """An FMU that is stepped by hand; used as a context manager. ``messages`` are what it has logged."""

    def __init__(self, path: Path, folder: Path, *, early: bool = False, events: bool = False) -> None:
        self._folder = folder
        fmpy.extract(str(path), str(folder))
        self.description = fmpy.read_model_description(str(folder))
        self.is_new = self.description.fmiVersion == "3.0"
        self.variables = {item.name: item for item in self.description.modelVariables}
        self._early, self._events = early, events
        self.messages: list[str] = []
        self.fmu = self.instance("one")

    def instance(self, name: str) -> Any:
        """A further instance of the same library."""
        facts = {
            "guid": self.description.guid,
            "modelIdentifier": self.description.coSimulation.modelIdentifier,
            "unzipDirectory": str(self._folder),
            "instanceName": name,
        }
        fmu = FMU3Slave(**facts) if self.is_new else FMU2Slave(**facts)
        if self.is_new:

            def logged(environment: Any, status: int, category: bytes, message: bytes) -> None:
                self.messages.append(message.decode())

            fmu.instantiate(
                loggingOn=True, eventModeUsed=self._events, earlyReturnAllowed=self._early, logMessage=logged
            )
        else:
            self._callbacks = callbacks(self.messages)
            fmu.instantiate(callbacks=self._callbacks, loggingOn=True)
        return fmu

    def begin(self, fmu: Any = None, start: float = 0.0) -> None:
        """Initializes the instance."""
        fmu = fmu or self.fmu
        if self.is_new:
            fmu.enterInitializationMode(startTime=start)
        else:
            fmu.setupExperiment(startTime=start)
            fmu.enterInitializationMode()
        fmu.exitInitializationMode()

    def names(self, causality: str) -> list[str]:
        """The variables of a causality, without clocks and counts."""
        return [
            item.name
            for item in self.description.modelVariables
            if item.causality == causality and not item.name.endswith((".clock", ".count"))
        ]

    def _kind(self, name: str) -> str:
        kind = self.variables[name].type
        return ("Int64" if self.is_new else "Integer") if kind == "Enumeration" else kind

    def get(self, name: str, fmu: Any = None) -> Any:
        """The value of a variable."""
        return getattr(fmu or self.fmu, f"get{self._kind(name)}")([self.variables[name].valueReference])[0]

    def set(self, name: str, value: Any, fmu: Any = None) -> None:
        """Gives a variable a value."""
        getattr(fmu or self.fmu, f"set{self._kind(name)}")([self.variables[name].valueReference], [value])

    def outputs(self, fmu: Any = None) -> Values:
        """The values of all outputs."""
        return {name: self.get(name, fmu) for name in self.names("output")}

    def step(self, time: float, length: float, fmu: Any = None) -> float:
        """A step; its end."""
        fmu = fmu or self.fmu
        if not self.is_new:
            fmu.doStep(time, length)
            return time + length
        _, _, _, reached = fmu.doStep(time, length)
        return float(reached)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.fmu.freeInstance()
        shutil.rmtree(self._folder, ignore_errors=True)


def callbacks(messages: list[str]) -> Any:
    """Callbacks of FMI 2.0 that keep messages."""
    from fmpy.fmi2 import (
        calloc,
        fmi2CallbackAllocateMemoryTYPE,
        fmi2CallbackFreeMemoryTYPE,
        fmi2CallbackFunctions,
        fmi2CallbackLoggerTYPE,
        free,
    )

    def logged(environment: Any, name: bytes, status: int, category: bytes, message: bytes) -> None:
        messages.append(message.decode())

    made = fmi2CallbackFunctions()
    made.logger = fmi2CallbackLoggerTYPE(logged)
    made.allocateMemory = fmi2CallbackAllocateMemoryTYPE(calloc)
    made.freeMemory = fmi2CallbackFreeMemoryTYPE(free)
    return made


def together(program: Instance, plant: Instance, until: float, length: float) -> Iterator[tuple[float, Values]]:
    """Both from 0 to ``until`` in steps of ``length`` seconds; the values of all ports after each step, also after one
    that ends earlier. The one that ends earlier decides for both.
    """
    program.begin()
    plant.begin()
    time, count = 0.0, 0
    while time < until - 1e-9:
        target = (count + 1) * length
        for one, other in ((program, plant), (plant, program)):
            for name, value in other.outputs().items():
                one.set(name, value)
        reached = program.step(time, target - time)
        plant.step(time, reached - time)
        time = reached
        count += 1 if reached >= target else 0
        yield time, {**program.outputs(), **plant.outputs()}
