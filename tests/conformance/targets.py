"""What can be certified: the implementations of the language, each behind the same small object.

A target of one's own is one more class like these, and an entry in ``TARGETS``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

from cspdiag import pipeline
from cspdiag.codegen import target_errors
from cspdiag.network.ir.network import Network
from cspdiag.runtime.kernel.exceptions import described
from cspdiag.semantics import execute as semantics
from cspdiag.semantics.trace import Communication, Ending, Execution
from cspdiag.simulate.native import run as native
from cspdiag.simulate.native.build import CompilerError, find_compiler
from cspdiag.simulate.record.recorder import Recorder
from cspdiag.simulate.result import Run
from cspdiag.simulate.run import reference
from cspdiag.simulate.run.execute import chosen_environment, simulate
from tests.conformance.sources import read
from tests.conformance.states import ObservedRun


class RefusedError(Exception):
    """A correct program that the target cannot take, with what it says."""


class Target(Protocol):
    """An implementation of the language."""

    @property
    def name(self) -> str:
        """As the command line calls it."""
        ...

    @property
    def other_library(self) -> bool:
        """Whether its mathematical functions are not those of this machine's C library, so that results may differ by
        one unit in the last place.
        """
        ...

    @property
    def inside(self) -> bool:
        """Whether it tells of the communications inside a program, besides those of external ports."""
        ...

    def unavailable(self) -> str | None:
        """Why it cannot run here, None where it can."""
        ...

    def run(self, network: Network, environment: str | None, until: int) -> Execution:
        """What it does with a program, in an environment, up to ``until`` nanoseconds; RefusedError where it takes no
        such program.
        """
        ...

    def waits(
        self, network: Network, environment: str | None, until: int, communication: int
    ) -> tuple[str, ...] | None:
        """What each process waits for once so many communications have been made; None where it cannot tell."""
        ...


@dataclass(frozen=True)
class GeneratedPython:
    """The Python that ``cspdiag compile`` makes, imported and run.

    ``observed`` code keeps processes apart that would be fused; code that is not ``traced`` tells of external ports
    alone.
    """

    level: int
    observed: bool = False
    traced: bool = True
    other_library: bool = False

    @property
    def name(self) -> str:
        """See ``Target.name``."""
        return f"python-O{self.level}{'-observed' * self.observed}{'-untraced' * (not self.traced)}"

    @property
    def inside(self) -> bool:
        """See ``Target.inside``."""
        return self.traced

    def unavailable(self) -> str | None:
        """See ``Target.unavailable``."""
        return None

    def run(self, network: Network, environment: str | None, until: int) -> Execution:
        """See ``Target.run``."""
        return execution(self._simulate(network, environment, until, Recorder()))

    def waits(
        self, network: Network, environment: str | None, until: int, communication: int
    ) -> tuple[str, ...] | None:
        """See ``Target.waits``."""
        if self.level > 0:
            return None
        observer = ObservedRun(communication)
        self._simulate(network, environment, until, observer)
        return observer.waits

    def _simulate(self, network: Network, environment: str | None, until: int, recorder: Recorder) -> Run:
        try:
            files = pipeline.generate(network, read, "python", self.level, traced=self.traced, observed=self.observed)
        except target_errors() as problem:
            raise RefusedError(str(problem)) from problem
        return simulate(network, files, environment=environment, until=until, recorder=recorder)


@dataclass(frozen=True)
class NativeSimulation:
    """The C that ``cspdiag compile --target c`` makes, with its environment compiled in.

    The optimizer of the C compiler is left out, for speed, unless the environment variable CFLAGS asks for it.
    """

    level: int
    observed: bool = False
    other_library: bool = False
    inside: bool = True

    @property
    def name(self) -> str:
        """See ``Target.name``."""
        return f"c-O{self.level}{'-observed' * self.observed}"

    def unavailable(self) -> str | None:
        """See ``Target.unavailable``."""
        try:
            find_compiler()
        except CompilerError as problem:
            return str(problem)
        return None

    def run(self, network: Network, environment: str | None, until: int) -> Execution:
        """See ``Target.run``."""
        try:
            run = native.simulate(
                network,
                read,
                level=self.level,
                environment=environment,
                until=until,
                fused=not self.observed,
                options=("-O0",),
            )
        except target_errors() as problem:
            raise RefusedError(str(problem)) from problem
        return execution(run)

    def waits(
        self, network: Network, environment: str | None, until: int, communication: int
    ) -> tuple[str, ...] | None:
        """See ``Target.waits``."""
        return None


def execution(run: Run) -> Execution:
    """What a run has recorded."""
    outcome = run.outcome
    error = outcome.error
    ending = Ending(
        outcome.ended,
        outcome.time,
        None if error is None else type(error).__name__,
        None if error is None else described(error),
    )
    trace = [Communication._make(communication) for communication in run.communications]
    return Execution(trace, ending, [(port, value) for _, port, value in run.releases])


READABLE = GeneratedPython(0)

_PLACE = ", in "
"""Between what a failure says and where it was."""


@dataclass(frozen=True)
class Meaning:
    """What the language says.

    Of bodies in other languages it says nothing, nor in which line a failure is: both are asked of the readable code.
    """

    name: str = "reference"
    other_library: bool = False
    inside: bool = True

    def unavailable(self) -> str | None:
        """It is always there."""
        return None

    def run(self, network: Network, environment: str | None, until: int) -> Execution:
        """See ``Target.run``."""
        if semantics.has_bodies_of_other_languages(network, environment):
            return READABLE.run(network, environment, until)
        done = semantics.execute(network, environment, until)
        chosen = chosen_environment(network, environment)
        error = reference.outcome_of(done, "" if chosen is None else chosen.name, network).error
        if error is None:
            return done
        message = described(error)
        placed = READABLE.run(network, environment, until).ending.message
        if placed is not None and placed.partition(_PLACE)[0] == message.partition(_PLACE)[0]:
            message = placed
        return done._replace(ending=done.ending._replace(message=message))

    def waits(
        self, network: Network, environment: str | None, until: int, communication: int
    ) -> tuple[str, ...] | None:
        """See ``Target.waits``."""
        if semantics.has_bodies_of_other_languages(network, environment):
            return READABLE.waits(network, environment, until, communication)
        return semantics.waits(network, environment, until, communication)


REFERENCE = Meaning()
"""What everything else is compared with."""

TARGETS: Mapping[str, Target] = {
    target.name: target
    for target in (
        READABLE,
        GeneratedPython(1),
        GeneratedPython(1, observed=True),
        GeneratedPython(1, traced=False),
        NativeSimulation(0),
        NativeSimulation(1),
        NativeSimulation(1, observed=True),
    )
}


def target_named(name: str) -> Target:
    """A target by its name, or the name before the level (``c``: at level 1); KeyError if there is none."""
    return TARGETS[name] if name in TARGETS else TARGETS[f"{name}-O1"]
