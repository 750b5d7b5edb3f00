"""Imports that cannot be read, whatever the reason."""

from __future__ import annotations

import pytest

from cspdiag.base import Report, SourceFile
from cspdiag.model.names.imports import load
from cspdiag.model.names.resolve import resolve


@pytest.mark.parametrize(
    "error",
    [
        FileNotFoundError(2, "No such file or directory"),
        IsADirectoryError(21, "Is a directory"),
        PermissionError(13, "Permission denied"),
        UnicodeDecodeError("utf-8", b"\xff", 0, 1, "invalid start byte"),
        ValueError("embedded null byte"),
        OSError("no reason"),
    ],
)
def test_an_unreadable_file_is_a_diagnostic(error: Exception) -> None:
    def read(path: str) -> SourceFile:
        raise error

    report = Report()
    trees = load(SourceFile(name="main.csp", text='import "other.csp"\nconst x = 1\n'), read, report)
    assert [found.code for found in report.diagnostics] == ["E0120"]
    assert len(trees) == 1


def test_paths_are_relative_to_the_importing_file() -> None:
    files = {
        "models/laws/pid.csp": 'import "../units.csp"\n',
        "models/units.csp": "const half = 0.5\n",
    }
    requested: list[str] = []

    def read(path: str) -> SourceFile:
        requested.append(path)
        return SourceFile(name=path, text=files[path])

    report = Report()
    main = SourceFile(name="models/main.csp", text='import "laws/pid.csp"\nimport "units.csp"\n')
    trees = load(main, read, report)
    assert not report.diagnostics
    assert requested == ["models/laws/pid.csp", "models/units.csp"]
    assert [tree.source.name for tree in trees] == ["models/main.csp", *requested]


def test_a_long_chain_of_imports() -> None:
    def read(path: str) -> SourceFile:
        number = int(path.removesuffix(".csp"))
        return SourceFile(name=path, text=f'import "{number + 1}.csp"\n' if number < 2000 else "")

    report = Report()
    trees = load(SourceFile(name="main.csp", text='import "0.csp"\n'), read, report)
    assert not report.diagnostics
    assert len(trees) == 2002


def test_a_definition_of_the_bundled_library_cannot_be_replaced() -> None:
    def read(path: str) -> SourceFile:
        raise FileNotFoundError(path)

    report = Report()
    text = "import std.control\n\nexception LowPass\n"
    resolve(load(SourceFile(name="main.csp", text=text), read, report), {}, report)
    (found,) = report.diagnostics
    assert (found.code, found.span.text) == ("E0201", "LowPass")
    assert found.help == "the bundled library std.control defines `LowPass`; choose another name"
    assert found.labels[0].span.file == "std/control.csp"
