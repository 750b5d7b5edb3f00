"""The Python interface: a loaded program, and everything that can be done with it without intermediate files."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Literal

from cspdiag import pipeline
from cspdiag.arguments import (
    Setting,
    Values,
    definition_to_draw,
    execution_time,
    labels_to_hide,
    measured_times,
    require_depth,
    require_level,
    require_names,
    require_one_of,
    require_seconds,
    require_states,
    require_text,
    require_way_to_run,
    settings_of,
    shown,
    source_of,
    time_limit,
    values_of,
)
from cspdiag.base import Diagnostic, SourceFile
from cspdiag.base.errors import ArgumentError, CspdiagError, file_errors
from cspdiag.base.sources import read_source
from cspdiag.drawing import Drawing
from cspdiag.model.types import REALS
from cspdiag.obligations import proof_obligations

if TYPE_CHECKING:
    import networkx

    from cspdiag.analyses.margins.loops import LoopReport
    from cspdiag.analyses.timing.result import TimingReport
    from cspdiag.draw.pictures import Which
    from cspdiag.model.program import Program
    from cspdiag.model.types import Real
    from cspdiag.network.ir.network import CoreNetwork
    from cspdiag.proofs.answers.answer import Answer
    from cspdiag.running import Tune
    from cspdiag.simulate.result import Run
    from cspdiag.sweep.table import Sweep


class ProgramError(CspdiagError):
    """The program has errors; the message shows them all, ``diagnostics`` has them as objects."""

    def __init__(self, diagnostics: list[Diagnostic]) -> None:
        from cspdiag.base.render.text import render

        super().__init__(f"the program has errors\n\n{render(diagnostics)}")
        self.diagnostics = diagnostics


def load(path: str | os.PathLike[str], *, real: Real = "double") -> LoadedProgram:
    """The program in a file; ``-`` is standard input. ``real`` is what ``double`` means in the program: with
    ``"float32"`` it computes in single precision. Raises FileError for a file that cannot be read or is not text, and
    ArgumentError for another ``real``.
    """
    require_one_of("real", real, REALS)
    with file_errors():
        return LoadedProgram(read_source(os.fsdecode(path)), real)


def parse(text: str, name: str, *, real: Real = "double") -> LoadedProgram:
    """The program in a text; ``name`` is what messages call it, and imports are relative to its folder. ``real`` is as
    for ``load``.

    Raises TypeError if it is not a ``str``, ArgumentError if it contains zero bytes or unpaired surrogates.
    """
    require_one_of("real", real, REALS)
    return LoadedProgram(source_of(text, name), real)


class LoadedProgram:
    """The text of a program; everything about it is computed on demand. ``read`` reads the files that it names."""

    def __init__(self, source: SourceFile, real: Real = "double", read: pipeline.Reader = read_source) -> None:
        self.source = source
        self._real: Real = real
        self._read = read

    def __repr__(self) -> str:
        return f"LoadedProgram({self.source.name!r})"

    def _repr_html_(self) -> str | None:
        """The diagrams of all processes and environments, the outermost process unfolded, or its errors; None if
        nothing can be drawn.
        """
        from cspdiag.draw.book.notebook import notebook
        from cspdiag.draw.layout.graph import LayoutError
        from cspdiag.draw.missing import MissingToolError

        try:
            return notebook(self._checked.readable, self._checked.report.diagnostics)
        except (MissingToolError, LayoutError):
            return None

    @cached_property
    def _findings(self) -> pipeline.Checked:
        return pipeline.check(self.source, self._read, for_findings=True, real=self._real)

    @cached_property
    def _checked(self) -> pipeline.Checked:
        found = self._findings
        is_whole = found.analysis is not None or bool(found.report.diagnostics)
        return found if is_whole else pipeline.check(self.source, self._read, real=self._real)

    def check(self) -> list[Diagnostic]:
        """All errors and warnings, by file and place; empty if there are none."""
        return self._findings.report.diagnostics

    @cached_property
    def network(self) -> CoreNetwork:
        """The network of the outermost process. Raises the same exceptions as ``build``."""
        return self.build()

    def build(
        self,
        *,
        top: str | None = None,
        environment: str | None = None,
        set: Mapping[str, Setting] | None = None,
    ) -> CoreNetwork:
        """The network of the process ``top`` for an environment, with constants and parameters set.

        Raises ProgramError, ``SettingError`` for a setting that matches nothing, and ``SelectionError`` if there is no
        such process or environment, or no process at all.
        """
        return self._build(top, environment, set, alone=False)

    def _build(
        self, top: str | None, environment: str | None, set: Mapping[str, Setting] | None, *, alone: bool
    ) -> CoreNetwork:
        require_names(top=top, environment=environment)
        built = pipeline.build(
            self.source,
            self._read,
            top=top,
            environment=environment,
            settings=settings_of(set),
            alone=alone,
            real=self._real,
        )
        if built.network is None:
            raise ProgramError(built.checked.report.diagnostics)
        return built.network

    def _settable(self) -> CoreNetwork:
        """The network of the outermost process with fixed parameters, for an FMU."""
        from cspdiag.simulate.fmu.settable import settable

        built = pipeline.build(self.source, self._read, real=self._real)
        if built.network is None:
            raise ProgramError(built.checked.report.diagnostics)
        return settable(built, None, None).network

    def _program(self) -> Program:
        """The program; it has no errors."""
        assert self._checked.program is not None
        return self._checked.program

    def graph(
        self,
        *,
        top: str | None = None,
        environment: str | None = None,
        set: Mapping[str, Setting] | None = None,
    ) -> networkx.MultiDiGraph:
        """The network as a graph: instances, external ports and environments, and the channels between them.

        Nodes are paths; an edge leads from each writer of a channel to each reader. Periods are in nanoseconds;
        ``docs/drawing.md`` lists all attributes. Arguments and errors are those of ``build``.
        """
        from cspdiag.draw.exchange.network_graph import network_graph

        return network_graph(self.build(top=top, environment=environment, set=set))

    def compile(self, target: str = "python", *, level: int = 0, framework: str = "") -> dict[str, str]:
        """The generated package: texts by path; ``level`` is 1 for fast code. ``framework`` makes a package in C a
        library for ``"zephyr"``, ``"esp-idf"``, ``"platformio"`` or ``"arduino"``. Raises the exceptions of ``build``,
        ArgumentError for an unknown target, level or framework, ``TargetError`` for a program that the target cannot
        express, and FileError for a module of the program that cannot be read.
        """
        from cspdiag.codegen import TARGETS
        from cspdiag.codegen.options import FRAMEWORKS
        from cspdiag.codegen.python.valid import require_valid

        require_one_of("target", target, TARGETS)
        require_one_of("framework", framework, ("", *FRAMEWORKS) if target == "c" else ("",))
        require_level(level)
        network = self._settable() if target == "fmu" else self.network
        with file_errors():
            files = pipeline.generate(network, self._read, target, level, framework=framework)
        if target == "python":
            require_valid(files)
        return files

    def draw(
        self,
        process: str | None = None,
        *,
        diagram: Which = "both",
        hide_labels: bool | Iterable[str] = False,
        depth: int = 1,
        check: bool = False,
    ) -> Drawing:
        """The diagrams of a process or an environment, by default of the outermost process, as a notebook shows them.

        ``hide_labels`` hides all labels, or those named, or all of one sort (``"types"``); ``depth`` 2 shows the inside
        of instances. With ``check`` a program with errors is drawn as far as it can be read, with its errors and
        warnings marked. Raises ProgramError for a program with errors otherwise, ``SelectionError`` if there is nothing
        of that name to draw, ArgumentError if there is nothing of that name to hide, and ``MissingToolError`` without
        ``cspdiag[draw]``.
        """
        from cspdiag.draw.pictures import PictureOptions, Pictures

        require_names(process=process)
        require_one_of("diagram", diagram, ("communication", "composition", "both"))
        require_depth(depth)
        checked = self._checked
        if checked.readable is None or (checked.report.has_errors and not check):
            raise ProgramError(checked.report.diagnostics)
        pictures = Pictures(checked.readable, checked.report.diagnostics if check else (), checked.analysis)
        definition = definition_to_draw(pictures, process)
        hide = labels_to_hide(pictures, definition, hide_labels, depth)
        return Drawing(pictures.scene(definition, PictureOptions(which=diagram, hidden=hide, depth=depth)))

    def draw_deadlock(self, run: Run) -> Drawing:
        """A picture of which process waits for which in a run of this program that ended in a deadlock, as drawn by
        ``cspdiag run --draw-deadlock``. Raises ArgumentError if the run ended otherwise, and ``MissingToolError``
        without ``cspdiag[draw]``.
        """
        from cspdiag.draw.deadlock.ring import draw_deadlock
        from cspdiag.simulate.result import Run
        from cspdiag.verify.deadlock_picture import deadlock_of

        if not isinstance(run, Run):
            raise TypeError(f"expected a Run, not {type(run).__name__}")
        if run.outcome.deadlock is None:
            raise ArgumentError(f"the run did not end in a deadlock: {run.outcome.ended}")
        return Drawing(draw_deadlock(deadlock_of(run.outcome.deadlock, run.network), self._checked.program))

    def timing(
        self,
        *,
        top: str | None = None,
        set: Mapping[str, Setting] | None = None,
        measured: Mapping[str, float] | None = None,
        kernel: float = 0,
    ) -> TimingReport:
        """Response times, latencies and advice for the sampled loops, as ``cspdiag verify --timing`` shows them.

        ``measured`` has execution times of laws in seconds by path, which replace stated ones, and ``kernel`` is the
        measured time of the kernel at an instant, as ``kernelTime``. Raises the exceptions of ``build``, and
        ArgumentError for an unknown path or a negative time.
        """
        from cspdiag.analyses.timing.report.timing import timing_report

        network = self.build(top=top, set=set)
        times = measured_times(network, measured)
        return timing_report(network, times, kernel=execution_time("kernel", kernel))

    def margins(
        self,
        environment: str | None = None,
        *,
        set: Mapping[str, Setting] | None = None,
        at: Mapping[str, float] | None = None,
    ) -> LoopReport:
        """Stability and margins of the loops through the plant of an environment (the first one by default), as
        ``cspdiag margins`` shows them.

        ``at`` has values of states of the plant at the operating point. Raises the exceptions of ``build``,
        ``NoEnvironmentError``, ArgumentError for a state that the plant does not have, and ``NotLinearError`` if a loop
        cannot be linearized.
        """
        from cspdiag.analyses.margins.loops import analyse_loops
        from cspdiag.simulate.run.execute import NoEnvironmentError, chosen_environment

        network = self._build(None, environment, set, alone=True)
        chosen = chosen_environment(network, environment)
        if chosen is None:
            raise NoEnvironmentError(f"`{network.top}` has no environment, and so no plant that would close its loops")
        require_states(chosen, {} if at is None else at)
        return analyse_loops(network, chosen, point=at)

    def run(
        self,
        environment: str | None = None,
        *,
        process: str | None = None,
        until: str | float | None = None,
        set: Mapping[str, Setting] | None = None,
        real_time: bool = False,
        target: str = "python",
        level: int | Literal["reference"] = 1,
        tune: Tune | None = None,
    ) -> Run:
        """Run the program against an environment (the first one by default), until ``until``: ``"20 s"``, or a number
        of seconds.

        ``process`` is the outermost one, by default that of the environment. ``target="c"`` builds and runs a native
        program, and ``target="auto"`` does so where that is possible, as ``Run.chosen_target`` says. With ``level=0``
        the readable code runs instead of the fast one. The results are the same. With ``level="reference"`` the
        reference semantics runs the program, which is slow and shares nothing with the generated code. ``tune`` changes
        parameters of the program: ``{"2 s": {"gains.kp": 3}}``, or a ``Tuning``, by which another thread does.

        Raises the exceptions of ``build``, ``NoEnvironmentError``, ``BodyError``, for C also ``CompilerError`` and
        ``TargetError``, for the reference ``NoMeaningError``, and ArgumentError for an unknown level or target.
        """
        from cspdiag.running import run_network, run_on_reference

        require_way_to_run(level, target, real_time=real_time)
        limit = None if until is None else time_limit(until)
        network = self._build(process, environment, set, alone=True)
        if level == "reference":
            return run_on_reference(network, self._program(), environment, limit, tune)
        return run_network(
            network, self._program(), self._read, environment, limit, tune, target, level, real_time=real_time
        )

    def sweep(
        self,
        set: Mapping[str, Values],
        measure: str | Iterable[str] = (),
        *,
        environment: str | None = None,
        until: str | float | None = None,
        target: str = "auto",
        workers: int | None = None,
        dask: str | None = None,
    ) -> Sweep:
        """Run the program with all combinations of values, and tabulate what is measured.

        ``set`` has, by name, a range as text (``"0.1:0.5:9"``), a sequence of values, or one value; ``measure`` texts
        such as ``"rms(pan.speed)"``. ``docs/sweeps.md`` lists both. ``until`` ends each run. Runs are native where that
        is possible, or as ``target`` says (``"c"``, ``"python"``), with the same results, in as many processes as there
        are processors, or ``workers``; or on the Dask cluster whose scheduler has the address ``dask``.

        Raises the exceptions of ``build``, ``NoEnvironmentError``, ``MeasureError``, for C also ``CompilerError`` and
        ``TargetError``, and ArgumentError for other values.
        """
        from cspdiag.running import measured_runs
        from cspdiag.sweep.plan import InvalidProgramError, Request

        require_names(environment=environment, dask=dask)
        require_one_of("target", target, ("auto", "c", "python"))
        if workers is not None and not (isinstance(workers, int) and 1 <= workers <= 1024):
            raise ArgumentError(f"workers is a number of processes from 1 to 1024, not {shown(workers)}")
        measures = [measure] if isinstance(measure, str) else list(measure)
        for text in measures:
            require_text("a measure", text)
        request = Request(
            source=self.source,
            given=values_of(set),
            measures=measures,
            environment=environment,
            until=None if until is None else time_limit(until),
            real=self._real,
        )
        try:
            return measured_runs(request, self._read, target, workers, dask)
        except InvalidProgramError as problem:
            raise ProgramError(list(problem.diagnostics)) from None

    def verify(
        self,
        process: str | None = None,
        *,
        set: Mapping[str, Setting] | None = None,
        time_limit: float = 60.0,
    ) -> list[Answer]:
        """The answers to the assertions of the file, or those about ``process``, in text order; see ``Answer``. If
        there are none, freedom from deadlock and from livelock is checked; a library, which has no process that is a
        program by itself, has no answers. ``time_limit`` is in seconds, for each.
        Raises the exceptions of ``build``, ``VerificationError`` if nothing can be answered, and ArgumentError for an
        invalid time limit.
        """
        from cspdiag.proofs.verdict import Limits
        from cspdiag.verify.confirm import Verifier

        seconds = require_seconds("time_limit", time_limit)
        require_names(process=process)
        settings = settings_of(set)
        obligations = proof_obligations(self.source, self._read, process=process, settings=settings, real=self._real)
        obligations.lower()
        if obligations.checked.report.has_errors:
            raise ProgramError(obligations.checked.report.diagnostics)
        verifier = Verifier(obligations, self._read, settings=settings)
        return [verifier.answer(question, Limits(seconds)) for question in obligations.questions]
