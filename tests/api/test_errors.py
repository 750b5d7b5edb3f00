"""Whatever the library raises is a ``CspdiagError``, and says in words what is wrong."""

from __future__ import annotations

import ast
import importlib
import math
import pickle
from collections.abc import Callable
from pathlib import Path

import pytest

import cspdiag
from cspdiag.base.errors import file_error

MODELS = Path(__file__).parents[2] / "models"
JIWY = MODELS / "jiwy/jiwy.csp"
PACKAGE = Path(cspdiag.__file__).parent

CAUGHT_INSIDE = {
    "UndefinedError", "OutOfRangeError", "NoPartError", "EvaluationFault", "NeedsLoad", "Restart", "TransitionError",
    "LimitError", "SolverTimeoutError", "TooLargeError", "NoSuchElementError", "UnboundedError", "AstrayError",
    "NotStaticError", "NoFormError", "NoElementError", "NoValueError", "UnknownError", "IrregularError",
    "UnknownSyntaxError",
    "NoResultError", "UsageError", "NoRepositoryError", "RaisedError", "CancelledError", "DeclaredError",
    "FaultError", "MissedSampleError", "FailureError",
}  # fmt: skip
"""What the callers always catch: the command line catches UsageError and NoRepositoryError, LimitError is not an
``Exception``, and the interpreter catches the last six.
"""


def exceptions_of_the_library() -> dict[str, type[BaseException]]:
    """Exceptions that are not private, and not of the runtime and the devices, which generated packages contain without
    the library.
    """
    found = {}
    for path in PACKAGE.rglob("*.py"):
        if path.is_relative_to(PACKAGE / "runtime") or path.is_relative_to(PACKAGE / "devices"):
            continue
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_") and node.bases:
                module = ".".join(("cspdiag", *path.relative_to(PACKAGE).with_suffix("").parts))
                kind = getattr(importlib.import_module(module), node.name)
                if issubclass(kind, BaseException):
                    found[node.name] = kind
    return found


def test_every_exception_that_can_escape_has_one_base() -> None:
    found = exceptions_of_the_library()
    assert set(found) >= CAUGHT_INSIDE, "a name that is excused is no exception any more"
    below = {name for name, kind in found.items() if issubclass(kind, cspdiag.CspdiagError)}
    assert set(found) - below == CAUGHT_INSIDE
    assert {name for name in cspdiag.__all__ if name.endswith("Error")} <= below


def program() -> cspdiag.LoadedProgram:
    return cspdiag.load(JIWY)


WRONG: list[tuple[str, Callable[[], object], type[Exception], str]] = [
    ("missing file", lambda: cspdiag.load("nowhere/missing.csp"), FileNotFoundError,
     "nowhere/missing.csp: no such file"),
    ("directory", lambda: cspdiag.load(MODELS), IsADirectoryError, "models: is a directory"),
    ("no path", lambda: cspdiag.load("a\0b"), OSError, "null"),
    ("text with zero bytes", lambda: cspdiag.parse("process A {\0}", "a.csp"), ValueError, (
        "a.csp: not text .a zero byte at offset 11"
    )),
    ("half a character", lambda: cspdiag.parse("// \ud800"), ValueError, (
        "program.csp: not text .half a character at offset 3"
    )),
    ("text with errors", lambda: cspdiag.parse("process {}").run(), cspdiag.ProgramError, "program.csp:1:9"),
    ("process to run", lambda: program().run(process="Jwiy"), cspdiag.SelectionError, (
        "there is no process `Jwiy` .did you mean `Jiwy`"
    )),
    ("process to build", lambda: program().build(top="Jwiy"), ValueError, "did you mean `Jiwy`"),
    ("process to verify", lambda: program().verify("Jwiy"), ValueError, "did you mean `Jiwy`"),
    ("process to draw", lambda: program().draw("Jwiy"), cspdiag.SelectionError, (
        "there is no process or environment `Jwiy` .did you mean `Jiwy`"
    )),
    ("nothing to draw", lambda: cspdiag.parse("const A = 1").draw(), cspdiag.SelectionError, "no process to draw"),
    ("environment", lambda: program().run("Bnch"), ValueError, "did you mean `Bench`"),
    ("environment of another process", lambda: program().run("Bench", process="Align"), cspdiag.SelectionError, (
        "^`Bench` is an environment for `Jiwy`, not for `Align`, which has none$"
    )),
    ("no environment of a process", lambda: program().run("Bnch", process="Align"), cspdiag.SelectionError, (
        "^there is no environment `Bnch` for `Align`$"
    )),
    ("neither process nor environment", lambda: program().run("Bnch", process="Jwiy"), cspdiag.SelectionError, (
        "there is no process `Jwiy` .did you mean `Jiwy`"
    )),
    ("negative time", lambda: program().run(until=-1), ValueError, "a run cannot last -1.0 s"),
    ("negative time in words", lambda: program().run(until="-1 s"), ValueError, "a run cannot last -1 s"),
    ("no time", lambda: program().run(until="soon"), ValueError, "`soon` is not a time"),
    ("time that is not a number", lambda: program().run(until=math.nan), ValueError, "`nan s` is not a time"),
    ("truth for a time", lambda: program().run(until=True), ValueError, "`True s` is not a time"),
    ("level to run", lambda: program().run(level=2), cspdiag.ArgumentError, (
        "no optimization level 2: choose 0, 1 or 'reference'$"
    )),
    ("level to compile", lambda: program().compile(level=7), cspdiag.ArgumentError, (
        "no optimization level 7: choose 0 or 1$"
    )),
    ("target", lambda: program().compile("rust"), ValueError, "unknown target 'rust'"),
    ("time limit of proofs", lambda: program().verify(time_limit=-1), ValueError, "time_limit is a positive number"),
    ("no time limit", lambda: program().verify(time_limit=math.nan), ValueError, "time_limit is a positive number"),
    ("diagram", lambda: program().draw(diagram="x"), ValueError, "unknown diagram 'x'"),  # type: ignore[arg-type]
    ("depth", lambda: program().draw(depth=0), ValueError, "depth is at least 1"),
    ("label", lambda: program().draw(hide_labels=["nope"]), ValueError, "no label `nope`"),
    ("measured path", lambda: program().timing(measured={"nobody": 1}), ValueError, "no law or process `nobody`"),
    ("measured time", lambda: program().timing(measured={"Jiwy.vertical.homing.servo": -1}), ValueError, "not -1"),
    ("state", lambda: program().margins(at={"nobody": 1}), ValueError, "has no state `nobody` .it has: pan"),
    ("state nan", lambda: program().margins(at={"pan.speed": math.nan}), ValueError, "finite.* not nan"),
    ("state that is infinite", lambda: program().margins(at={"pan.speed": math.inf}), ValueError, "finite.* not inf"),
    ("limit that no timer has", lambda: program().verify(time_limit=1e300), ValueError, "up to 1e.06, not 1e.300"),
    ("kernel", lambda: program().timing(kernel=-1e-6), ValueError, "kernel is a number of seconds, not -1e-06"),
    ("measured for ages", lambda: program().timing(measured={"Jiwy.vertical.homing.servo": 1e300}), ValueError,
     "not 1e.300"),
    ("public name", lambda: program().run(until=0.01)["control"], KeyError, "no signal 'control'; there are: joystick"),
    ("unread signal", lambda: program().run(until=0.01).unread("control"), KeyError, "no signal 'control'"),
    ("folder to write to", lambda: program().run(until=0.01).to_csv("nowhere/run.csv"), FileNotFoundError,
     "nowhere/run.csv"),
    ("kind of plot", lambda: program().run(until=0.01).plot("run.doc"), ValueError, "not as run.doc"),
    ("no deadlock", lambda: program().draw_deadlock(program().run(until=0.01)), ValueError,
     "did not end in a deadlock"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("call", "kind", "reported"), [pytest.param(*rest, id=name.replace(" ", "-")) for name, *rest in WRONG]
)
def test_wrong_arguments_are_refused_with_a_reason(
    call: Callable[[], object], kind: type[Exception], reported: str
) -> None:
    with pytest.raises(cspdiag.CspdiagError, match=reported) as raised:
        call()
    assert isinstance(raised.value, kind)


def test_errors_of_the_program_come_as_diagnostics() -> None:
    with pytest.raises(cspdiag.CspdiagError) as raised:
        cspdiag.parse("process A {\n  composition { nobody }\n}\n", "a.csp").build()
    assert [str(found) for found in raised.value.diagnostics] == ["a.csp:2:17: there is no instance `nobody`"]
    with pytest.raises(cspdiag.CspdiagError) as of_a_file:
        cspdiag.load("nowhere.csp")
    assert list(of_a_file.value.diagnostics) == []


def test_a_picture_is_refused_with_a_reason(tmp_path: Path) -> None:
    pytest.importorskip("quickjs")
    try:
        drawing = program().draw()
    except cspdiag.MissingToolError as problem:
        pytest.skip(str(problem))
    for wrong in (
        lambda: drawing.svg("pink"),
        lambda: drawing.save(tmp_path / "a.gif"),
        lambda: drawing.save(tmp_path / "a.svg", scheme="pink"),
        lambda: drawing.save(tmp_path / "a.png", scale=-1),
        lambda: drawing.save(tmp_path / "nowhere" / "a.svg"),
    ):
        with pytest.raises(cspdiag.CspdiagError, match=r"pink|gif|-1|nowhere"):
            wrong()
    assert list(tmp_path.iterdir()) == []


def test_only_text_is_parsed() -> None:
    with pytest.raises(TypeError, match="`load` reads a file"):
        cspdiag.parse(b"process A {}")  # type: ignore[arg-type]


@pytest.mark.parametrize("end", ["\r\n", "\r"])
def test_a_text_is_read_as_a_file_is(tmp_path: Path, end: str) -> None:
    text = f"\ufeff// A program.{end}process A {{{end}  composition {{ skip }}{end}}}{end}"
    (tmp_path / "one.csp").write_bytes(text.encode())
    of_a_file, of_a_text = cspdiag.load(tmp_path / "one.csp"), cspdiag.parse(text, str(tmp_path / "one.csp"))
    assert of_a_text.source.text == of_a_file.source.text
    assert of_a_text.compile() == of_a_file.compile()
    (tmp_path / "two.csp").write_text("process B {\n  composition { skip }\n}\n")
    importing = 'import "two.csp"\nprocess A {\n  communication { b : B }\n  composition { b }\n}\n'
    assert cspdiag.parse(importing, str(tmp_path / "one.csp")).check() == []


def test_a_path_may_be_bytes() -> None:
    assert cspdiag.load(str(JIWY).encode()).source.name == str(JIWY)  # type: ignore[arg-type]


def test_a_failed_run_raises_an_exception_of_the_library() -> None:
    assert program().run(until=0.01).raise_if_unsuccessful() is None
    run = cspdiag.load(MODELS / "dining/deadlock.csp").run(until=1)
    with pytest.raises(cspdiag.RunError, match="deadlock"):
        run.raise_if_unsuccessful()
    failing = cspdiag.parse(
        "exception Jam\nprocess A {\n  composition { raise Jam }\n}\nenvironment E for A {}\n"
    ).run()
    with pytest.raises(cspdiag.RunError, match="Jam") as raised:
        failing.raise_if_unsuccessful()
    assert raised.value.__cause__ is failing.outcome.error


@pytest.mark.parametrize("kind", [OSError, FileNotFoundError, PermissionError, NotADirectoryError])
def test_errors_of_files_stay_what_they_are(kind: type[OSError]) -> None:
    problem = file_error(kind(2, "Gone away", "a.csp"))
    again = pickle.loads(pickle.dumps(problem))
    for each in (problem, again):
        assert isinstance(each, cspdiag.FileError)
        assert str(each) == "a.csp: gone away"
        assert (each.errno, each.filename) == (2, "a.csp")
    assert isinstance(problem, kind)
    assert file_error(problem) is problem


def test_a_missing_compiler_raises_an_exception_of_the_library(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", "no-such-compiler")
    with pytest.raises(cspdiag.CspdiagError, match="no-such-compiler"):
        program().run(until=0.01, target="c", set={"Tsh": "3 ms"})


def test_numbers_of_numpy_are_times() -> None:
    import numpy

    assert program().run(until=numpy.float64(0.01)).outcome.time == 10_000_000
