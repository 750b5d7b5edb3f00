"""The use from Python: a program that was loaded, without files in between."""

from __future__ import annotations

import os
from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING

from cspdiag import pipeline
from cspdiag.diagnostics import Diagnostic, SourceFile
from cspdiag.sources import read_source

if TYPE_CHECKING:
    from cspdiag.network.ir import Network
    from cspdiag.simulate.result import Run

Setting = str | int | float
"""A value as ``cspdiag run --set`` takes it (``"10 ms"``), or a plain number."""


class ProgramError(Exception):
    """The program has errors; the text shows them all, ``diagnostics`` has them as objects."""

    def __init__(self, diagnostics: list[Diagnostic]) -> None:
        from cspdiag.diagnostics.render_text import render

        super().__init__(f"the program has errors\n\n{render(diagnostics)}")
        self.diagnostics = diagnostics


def _written(value: Setting) -> str:
    """A setting as the language writes it: ``True`` is ``true`` there."""
    return str(value).lower() if isinstance(value, bool) else str(value)


def load(path: str | os.PathLike[str]) -> LoadedProgram:
    """The program in a file. Raises OSError for a file that cannot be read or is not text."""
    return LoadedProgram(read_source(os.fspath(path)))


class LoadedProgram:
    """A program, as text; what is asked of it is worked out then."""

    def __init__(self, source: SourceFile) -> None:
        self.source = source

    def __repr__(self) -> str:
        return f"LoadedProgram({self.source.name!r})"

    @cached_property
    def _checked(self) -> pipeline.Checked:
        return pipeline.check(self.source, read_source)

    def check(self) -> list[Diagnostic]:
        """Everything that is wrong, warnings included, by file and place; empty when all is well."""
        return self._checked.report.diagnostics

    @cached_property
    def network(self) -> Network:
        """The network of the outermost process. Raises what ``build`` raises."""
        return self.build()

    def build(
        self,
        *,
        top: str | None = None,
        environment: str | None = None,
        set: Mapping[str, Setting] | None = None,
    ) -> Network:
        """The network of the process ``top`` for an environment, with constants and parameters set.

        Raises ProgramError, ``SettingError`` for a setting that fits nothing, and ``cspdiag.network.lower.SelectionError`` where there is
        no such process or environment, or no process at all.
        """
        settings = {name: _written(value) for name, value in (set or {}).items()}
        built = pipeline.build(self.source, read_source, top=top, environment=environment, settings=settings)
        if built.network is None:
            raise ProgramError(built.checked.report.diagnostics)
        return built.network

    def compile(self, target: str = "python", *, level: int = 0) -> dict[str, str]:
        """The generated package: texts by path; ``level`` is 1 for fast code.

        Raises what ``build`` raises, and ValueError for an unknown target, or a program that the target cannot express.
        """
        from cspdiag.codegen import TARGETS

        if target not in TARGETS:
            raise ValueError(f"unknown target {target!r} (there are: {', '.join(TARGETS)})")
        return pipeline.generate(self.network, read_source, target, level)

    def run(
        self,
        environment: str | None = None,
        *,
        until: str | float | None = None,
        set: Mapping[str, Setting] | None = None,
        real_time: bool = False,
        target: str = "python",
        level: int = 1,
    ) -> Run:
        """Run the program against an environment (the first one by default), until ``until``: ``"20 s"``, or a number of seconds.

        ``target="c"`` builds and runs a native program; with ``level=0`` the readable code runs instead of the fast one. The results are the same.

        Raises what ``build`` raises, ``cspdiag.simulate.execute.NoEnvironmentError``, for C also
        ``cspdiag.simulate.native_build.CompilerError``, and ValueError for a level or target that there is not, or a program that the target cannot express.
        """
        from cspdiag.settings import parse_duration
        from cspdiag.simulate import execute, native

        if level not in (0, 1):
            raise ValueError(f"there is no level {level!r} of optimization: it is 0 or 1")
        if target not in ("python", "c"):
            raise ValueError(f"nothing runs the target {target!r}: it is 'python' or 'c'")
        network = self.build(environment=environment, set=set)
        limit = None if until is None else parse_duration(until if isinstance(until, str) else f"{until!r} s")
        if target == "c":
            return native.simulate(
                network, read_source, level=level, environment=environment, until=limit, real_time=real_time
            )
        files = pipeline.generate(network, read_source, level=level, traced=True, observed=True)
        return execute.simulate(network, files, environment=environment, until=limit, real_time=real_time)
