"""Builds native programs: every file once, cached by its content, its headers, the compiler and its options."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
import time
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from functools import cache, cached_property
from hashlib import sha256
from pathlib import Path

from cspdiag.base.errors import CspdiagError
from cspdiag.base.files.caches import cache_folder
from cspdiag.base.parent import RunningCommands
from cspdiag.base.record import record
from cspdiag.codegen.c.package.includes import with_headers
from cspdiag.codegen.c.package.messages import explained

REQUIRED = ("-std=c99", "-ffp-contract=off")
"""Options that are always used: the values of a program are defined to the last bit."""

_LARGEST_CACHE = 256 * 1024 * 1024
_BUILDING = "building-"
"""The prefix of folders in which a build works."""
_LONGEST_BUILD = 3600.0
"""Seconds after which such a folder is considered abandoned."""
_OVERFLOW = re.compile(r"region `(\w+)' overflowed by (\d+) bytes")
"""What the linker of GNU says of each memory of a board that is too small."""
_SMALLER = (
    "help: arrays and buffers take most of the memory; a run without --on has that of this machine, and shows the same"
)
_ELSEWHERE = ("-I", "-i", "--i", "-B", "@")
"""What options begin with that name folders and files outside of the package."""


class CompilerError(CspdiagError):
    """There is no C compiler, or it has rejected a file."""


class CompilationTimeoutError(CompilerError):
    """A C compiler was stopped because it took too long."""


@record
class Compiler:
    """A C compiler: the command and how its version describes itself."""

    command: tuple[str, ...]
    version: str


_CHOICE = (
    "help: the environment variable CC names the C compiler, as in CC=clang; without it the first of cc, gcc and clang "
    "is used"
)


def find_compiler() -> Compiler:
    """The compiler of the environment variable CC, or else the first of cc, gcc and clang. Raises CompilerError."""
    wanted = os.environ.get("CC")
    commands = [wanted] if wanted else ["cc", "gcc", "clang"]
    for text in commands:
        command = tuple(shlex.split(text))
        if command and shutil.which(command[0]) is not None:
            return Compiler(command, _version(command))
    if wanted:
        raise CompilerError(f"CC is {wanted}, and there is no such command\n  {_CHOICE}")
    raise CompilerError(
        "--target c needs a C compiler: install gcc or clang (Debian, Ubuntu: apt install gcc; macOS: xcode-select "
        "--install), "
        "or name one by the environment variable CC"
    )


@cache
def _version(command: tuple[str, ...]) -> str:
    try:
        done = subprocess.run([*command, "--version"], capture_output=True, text=True, check=False)
    except OSError as problem:
        raise CompilerError(f"{' '.join(command)} cannot be run: {problem.strerror}") from problem
    return done.stdout.partition("\n")[0]


@record
class Toolchain:
    """The compiler for another machine than this one: the command, its options, the libraries, and the linker script
    as a path among the files of the program.
    """

    command: tuple[str, ...]
    options: tuple[str, ...]
    libraries: tuple[str, ...]
    script: str


@record
class Build:
    """A program to be built from ``files`` (texts by path); ``sources`` are the paths that are compiled and linked."""

    files: Mapping[str, str]
    sources: Sequence[str]
    options: tuple[str, ...] = ("-O2",)
    folder: Path | None = None
    """The cache; None for the usual one."""
    toolchain: Toolchain | None = None
    """None: the compiler of this machine."""

    @cached_property
    def compiler(self) -> Compiler:
        """The compiler; CompilerError if none is installed."""
        command = None if self.toolchain is None else self.toolchain.command
        return find_compiler() if command is None else Compiler(command, _version(command))

    @cached_property
    def _compilers(self) -> RunningCommands:
        return RunningCommands()

    @cached_property
    def cache(self) -> Path:
        """The folder of the cache."""
        if self.folder is not None:
            return self.folder
        try:
            return Path(cache_folder(), "c")
        except OSError as problem:
            raise _unusable(problem, problem.filename) from problem

    @cached_property
    def _flags(self) -> tuple[str, ...]:
        others = shlex.split(os.environ.get("CFLAGS", "")) if self.toolchain is None else self.toolchain.options
        return (*self.options, *others, *REQUIRED)

    @cached_property
    def _folders(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(os.path.dirname(path) for path in self.files))

    def executable(self) -> Path:
        """The path of the program; only what is not in the cache is built. Raises CompilerError."""
        script = "" if self.toolchain is None else self.files[self.toolchain.script]
        return self._linked((), script)

    def library(self) -> Path:
        """The same of a shared library, whose sources have to be compiled as position-independent code."""
        whole = ("-Wl,--no-undefined",) if sys.platform == "linux" else ()
        return self._linked(("-shared", *whole), "")

    def _linked(self, options: tuple[str, ...], script: str) -> Path:
        digests = {path: self.digest(path) for path in self.sources}
        target = self.cache / "programs" / _hash([*digests.values(), *self._identity, *options, script])
        if _touched(target):
            return target
        objects = self._objects(digests)
        with _Scratch(self.cache) as scratch:
            linked = scratch / "program"
            self._run([*options, *objects, *self._libraries(scratch), "-o", str(linked)], None)
            _keep(linked, target)
        _bound(self.cache)
        return target

    def _libraries(self, scratch: Path) -> tuple[str, ...]:
        if self.toolchain is None:
            return ("-lm", "-pthread", "-ldl")
        script = scratch / "memory.ld"
        script.write_text(self.files[self.toolchain.script], encoding="utf-8")
        return (*self.toolchain.libraries, "-T", str(script))

    @cached_property
    def _identity(self) -> tuple[str, ...]:
        compiler_ = self.compiler
        return (*compiler_.command, compiler_.version, *self._flags)

    def digest(self, path: str) -> str:
        """The name in the cache, made of everything on which the object of a file depends: its text, all headers that
        it includes, the compiler and its options.
        """
        return _hash(
            [
                path,
                *(f"{name}\n{self.files[name]}" for name in with_headers([path], self.files, self._folders)),
                *self._identity,
                self._preprocessed.get(path, ""),
            ]
        )

    @cached_property
    def _preprocessed(self) -> Mapping[str, str]:
        """What the compiler reads in place of each source if options name other folders or files to include, which
        change without a sign in the package.
        """
        if not any(option.startswith(_ELSEWHERE) for option in self._flags):
            return {}
        with _Scratch(self.cache) as scratch:
            _write(scratch, self.files)
            made = scratch / "preprocessed"
            texts = {}
            for path in self.sources:
                self._run([*self._included_from(scratch), "-E", "-P", str(scratch / path), "-o", str(made)], scratch)
                texts[path] = made.read_text(encoding="utf-8", errors="replace")
            return texts

    def _included_from(self, scratch: Path) -> list[str]:
        return [option for folder in self._folders for option in ("-I", str(scratch / folder))]

    def _objects(self, digests: Mapping[str, str]) -> list[str]:
        """The objects of all sources; missing ones are compiled, in parallel on all processors."""
        places = {path: self.cache / "objects" / f"{digest}.o" for path, digest in digests.items()}
        missing = [path for path, place in places.items() if not _touched(place)]
        if missing:
            from cspdiag.codegen.c.laws.by_hand import FILE as TYPES_BY_HAND

            missing.sort(key=lambda path: not path.endswith(TYPES_BY_HAND))  # The first that fails is reported.
            with _Scratch(self.cache) as scratch:
                _write(scratch, self.files)
                with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
                    try:
                        list(pool.map(lambda path: self._compile(scratch, path, places[path]), missing))
                    except BaseException:
                        self._compilers.stop()  # Otherwise the pool waits for them.
                        raise
        return [str(place) for place in places.values()]

    def _compile(self, scratch: Path, path: str, place: Path) -> None:
        made = scratch / f"{path}.o"
        self._run([*self._included_from(scratch), "-c", str(scratch / path), "-o", str(made)], scratch)
        _keep(made, place)

    def assembled(self, path: str, *options: tuple[str, ...], patience: int | None = None) -> dict[str, str]:
        """The files that the compiler writes when it compiles a file to assembly, by suffix (``s``, ``su``), with the
        first options that it accepts. Raises CompilerError, also if that takes more than ``patience`` seconds of
        processor time.
        """
        with _Scratch(self.cache) as scratch:
            _write(scratch, self.files)
            folders = self._included_from(scratch)
            results = scratch / "results"
            results.mkdir()
            for position, chosen in enumerate(options):
                try:
                    self._run(
                        [*folders, *chosen, "-S", str(scratch / path), "-o", str(results / "made.s")],
                        scratch,
                        patience,
                        # ccache answers without the files of the call graph.
                        {**os.environ, "CCACHE_DISABLE": "1"},
                    )
                except CompilationTimeoutError:
                    raise
                except CompilerError:
                    if position + 1 == len(options):
                        raise
                    continue
                break
            return {entry.suffix[1:]: entry.read_text(encoding="utf-8") for entry in results.iterdir()}

    def keep_text(self, text: str, place: Path) -> None:
        """Put a text into the cache."""
        with _Scratch(self.cache) as scratch:
            made = scratch / "text"
            made.write_text(text, encoding="utf-8")
            _keep(made, place)

    def _run(
        self,
        arguments: list[str],
        scratch: Path | None,
        patience: int | None = None,
        environment: Mapping[str, str] | None = None,
    ) -> None:
        command = [*self.compiler.command, *self._flags, *arguments]
        # The limit is inherited by the processes that a compiler starts; a signal would only reach the compiler itself.
        limited = command if patience is None else ["sh", "-c", 'ulimit -t "$0"; exec "$@"', str(patience), *command]
        began = time.monotonic()
        try:
            done = self._compilers.run(limited, environment)
        except InterruptedError:
            raise CompilerError("the build was interrupted") from None
        except OSError as problem:
            raise CompilerError(f"{command[0]} cannot be run: {problem.strerror}") from problem
        if done.returncode != 0:
            if patience is not None and time.monotonic() - began >= patience:
                raise CompilationTimeoutError(f"{command[0]} computes for more than {patience} s")
            messages = done.stderr.strip() or done.stdout.strip()
            if not messages:
                code = done.returncode
                raise CompilerError(
                    f"the compiler {command[0]} ended with exit code {code} and no message\n  {_CHOICE}"
                )
            if too_large := {memory: int(size) for memory, size in _OVERFLOW.findall(messages)}:
                missing = " and ".join(f"{size:,} bytes of {memory}" for memory, size in too_large.items())
                raise CompilerError(f"the program is too large for the board: it needs {missing} more\n  {_SMALLER}")
            if scratch is not None:
                messages = messages.replace(f"{scratch}{os.sep}", "")
            raise CompilerError(f"{command[0]} failed:\n{explained(messages, self.files)}")


def _hash(parts: Iterable[str]) -> str:
    digest = sha256()
    for part in parts:
        digest.update(part.encode())
        digest.update(b"\0")
    return digest.hexdigest()[:40]


def _unusable(problem: OSError, folder: str | Path) -> CompilerError:
    return CompilerError(f"{folder} cannot be written: {problem.strerror}; XDG_CACHE_HOME names another place")


class _Scratch:
    """A separate folder next to the cache, from which complete files can be moved into it."""

    def __init__(self, folder: Path) -> None:
        self._parent = folder

    def __enter__(self) -> Path:
        from tempfile import mkdtemp

        try:
            self._parent.mkdir(parents=True, exist_ok=True)
            self._path = Path(mkdtemp(prefix=_BUILDING, dir=self._parent))
        except OSError as problem:
            raise _unusable(problem, self._parent) from problem
        return self._path

    def __exit__(self, *_: object) -> None:
        shutil.rmtree(self._path, ignore_errors=True)


def _write(folder: Path, files: Mapping[str, str]) -> None:
    for path, text in files.items():
        target = folder / path
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(text, encoding="utf-8", newline="\n")


def _keep(made: Path, place: Path) -> None:
    place.parent.mkdir(parents=True, exist_ok=True)
    os.replace(made, place)


def _touched(place: Path) -> bool:
    """Whether a file is in the cache; its last use is updated."""
    try:
        os.utime(place)
    except OSError:
        return False
    return True


def _bound(folder: Path) -> None:
    """Remove the least recently used entries if the cache is too large, and the remains of aborted builds."""
    for left in folder.glob(f"{_BUILDING}*"):
        with suppress(OSError):
            if time.time() - left.stat().st_mtime > _LONGEST_BUILD:
                shutil.rmtree(left, ignore_errors=True)
    entries: list[tuple[float, int, Path]] = []
    for part in ("objects", "programs", "facts"):
        with suppress(OSError):
            for entry in os.scandir(folder / part):
                with suppress(OSError):
                    facts = entry.stat()
                    entries.append((facts.st_mtime, facts.st_size, Path(entry.path)))
    size = sum(entry[1] for entry in entries)
    for _, freed, path in sorted(entries):
        if size <= _LARGEST_CACHE:
            return
        with suppress(OSError):
            path.unlink()
        size -= freed
