"""What can be certified: the implementations of the language, each with the same small interface.

To add a target of your own, write another class like these, and add it to ``TARGETS``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol
from zlib import crc32

from cspdiag import pipeline
from cspdiag.codegen import target_errors
from cspdiag.network.ir.network import Network
from cspdiag.runtime.kernel.exceptions import described
from cspdiag.semantics import execute as semantics
from cspdiag.semantics.trace import Communication, Ending, Execution
from cspdiag.simulate.native import run as native
from cspdiag.simulate.native.boards import BOARDS, Board
from cspdiag.simulate.native.build import CompilerError, find_compiler
from cspdiag.simulate.record.recorder import Recorder
from cspdiag.simulate.result import Run
from cspdiag.simulate.run import reference
from cspdiag.simulate.run.execute import simulate
from tests.conformance.random.changes import changes_of
from tests.conformance.sources import read
from tests.conformance.states import ObservedRun


class RefusedError(Exception):
    """A correct program that the target does not support, with the reason that it gives."""


class Target(Protocol):
    """An implementation of the language."""

    @property
    def name(self) -> str:
        """The name on the command line."""
        ...

    @property
    def other_library(self) -> bool:
        """Whether its mathematical functions are not those of this machine's C library, so results may differ by one
        unit in the last place.
        """
        ...

    @property
    def inside(self) -> bool:
        """Whether it reports the communications inside a program, besides those of external ports."""
        ...

    def unavailable(self) -> str | None:
        """Why it cannot run here; None if it can."""
        ...

    def run(self, network: Network, environment: str | None, until: int) -> Execution:
        """Run a program, in an environment, up to ``until`` nanoseconds. Raises RefusedError if the target does not
        support the program.
        """
        ...

    def waits(
        self, network: Network, environment: str | None, until: int, communication: int
    ) -> tuple[str, ...] | None:
        """What each process waits for after this number of communications; None if the target cannot say."""
        ...


@dataclass(frozen=True)
class GeneratedPython:
    """The Python that ``cspdiag compile`` generates, imported and run.

    ``observed`` code keeps apart processes that would be fused; code that is not ``traced`` reports only external
    ports.
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
        return simulate(
            network, files, environment=environment, until=until, recorder=recorder, changes=changes_of(network)
        )


WARNINGS = ("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror")
"""What generated C is free of; an engineer who compiles it may ask for any of these."""


@dataclass(frozen=True)
class NativeSimulation:
    """The C that ``cspdiag compile --target c`` generates, with its environment compiled in, without any warning.

    The optimizer of the C compiler is switched off, for speed, unless the environment variable CFLAGS switches it on.
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
                options=("-O0", *WARNINGS),
                changes=changes_of(network),
            )
        except target_errors() as problem:
            raise RefusedError(str(problem)) from problem
        return execution(run)

    def waits(
        self, network: Network, environment: str | None, until: int, communication: int
    ) -> tuple[str, ...] | None:
        """See ``Target.waits``."""
        return None


@dataclass(frozen=True)
class EmulatedBoard:
    """The C on an emulated processor, with the mathematical functions of its library; parameters keep their values."""

    board: Board
    level: int = 1
    other_library: bool = True
    inside: bool = True

    @property
    def name(self) -> str:
        """See ``Target.name``."""
        return self.board.name

    def unavailable(self) -> str | None:
        """See ``Target.unavailable``."""
        try:
            self.board.require_tools()
        except CompilerError as problem:
            return str(problem)
        return None

    def run(self, network: Network, environment: str | None, until: int) -> Execution:
        """See ``Target.run``."""
        try:
            run = native.simulate(
                network, read, level=self.level, environment=environment, until=until, fused=True, board=self.board
            )
        except target_errors() as problem:
            raise RefusedError(str(problem)) from problem
        return execution(run)

    def waits(
        self, network: Network, environment: str | None, until: int, communication: int
    ) -> tuple[str, ...] | None:
        """See ``Target.waits``."""
        return None


STEPS = Path(__file__).parent / "random_steps.c"


@dataclass(frozen=True)
class SteppedSimulation:
    """The same C, advanced in steps of random lengths by ``random_steps.c``, which takes the place of ``csp_run``."""

    level: int
    other_library: bool = False
    inside: bool = True

    @property
    def name(self) -> str:
        """See ``Target.name``."""
        return f"c-O{self.level}-steps"

    def unavailable(self) -> str | None:
        """See ``Target.unavailable``."""
        return NativeSimulation(self.level).unavailable()

    def run(self, network: Network, environment: str | None, until: int) -> Execution:
        """See ``Target.run``."""
        seed = crc32(f"{network.top} {environment} {len(network.instances)}".encode())
        program = f"#define SEED UINT64_C({seed})\n{STEPS.read_text(encoding='utf-8')}"
        try:
            built = native.build_program(
                network,
                read,
                level=self.level,
                environment=environment,
                fused=True,
                options=("-O0", *WARNINGS),
                replaced={"support/csp_run.c": program},
            )
        except target_errors() as problem:
            raise RefusedError(str(problem)) from problem
        return execution(built.run(until=until, changes=changes_of(network)))

    def waits(
        self, network: Network, environment: str | None, until: int, communication: int
    ) -> tuple[str, ...] | None:
        """See ``Target.waits``."""
        return None


def execution(run: Run) -> Execution:
    """What a run has recorded."""
    outcome = run.outcome
    error = outcome.error
    message = None if error is None else described(error)
    if outcome.deadlock is not None:
        message = outcome.deadlock.text
    ending = Ending(outcome.ended, outcome.time, None if error is None else type(error).__name__, message)
    trace = [Communication._make(communication) for communication in run.communications]
    return Execution(trace, ending, [(port, value) for _, port, value in run.releases])


READABLE = GeneratedPython(0)

_PLACE = ", in "
"""What separates the message of a failure from its place."""


@dataclass(frozen=True)
class Meaning:
    """The reference semantics of the language.

    It does not define bodies in other languages, or the line of a failure: both come from the readable code.
    """

    name: str = "reference"
    other_library: bool = False
    inside: bool = True

    def unavailable(self) -> str | None:
        """It is always available."""
        return None

    def run(self, network: Network, environment: str | None, until: int, *, changed: bool = True) -> Execution:
        """See ``Target.run``; unless parameters are to be ``changed``, they keep their values."""
        if semantics.has_bodies_of_other_languages(network, environment):
            return READABLE.run(network, environment, until)
        changes = changes_of(network) if changed else []
        run = reference.simulate(network, environment=environment, until=until, recorder=Recorder(), changes=changes)
        done = execution(run)
        if run.outcome.error is None:
            return done
        message = described(run.outcome.error)
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
"""The target with which all others are compared."""

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
        SteppedSimulation(0),
    )
}

"""Those that the tests compare on everything."""

EMULATED: Mapping[str, Target] = {name: EmulatedBoard(board) for name, board in BOARDS.items()}


def target_named(name: str) -> Target:
    """A target by its name, or by the name without the level (``c``: at level 1). Raises KeyError if there is no such
    target.
    """
    targets = {**TARGETS, **EMULATED}
    return targets[name] if name in targets else targets[f"{name}-O1"]
