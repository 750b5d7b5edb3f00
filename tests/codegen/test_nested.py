"""Deeply nested programs run on all targets as on the reference: Python limits how deeply a function can be nested."""

from __future__ import annotations

import subprocess
import sys
from functools import lru_cache
from pathlib import Path

import pytest

import cspdiag
from cspdiag import pipeline
from cspdiag.base import SourceFile
from cspdiag.cli.main import main
from cspdiag.codegen.python.text import splitting
from cspdiag.network.ir.network import Network
from cspdiag.semantics.trace import Execution
from cspdiag.simulate.native.build import find_compiler
from tests.conformance.kit import judge, parsed
from tests.conformance.random.compare import difference
from tests.conformance.random.known import known
from tests.conformance.random.meetings import meetings
from tests.conformance.sources import JUST_AFTER, PROGRAMS, environments, network_of, read
from tests.conformance.targets import REFERENCE, TARGETS
from tests.support.nested import FORMS, deepest, nested

LIMIT = 10_000_000 + JUST_AFTER


@lru_cache
def network(form: str, depth: int) -> Network:
    return network_of(SourceFile(name="nested.csp", text=nested(form, depth)))


@lru_cache
def reference(form: str, depth: int) -> Execution:
    return REFERENCE.run(network(form, depth), None, LIMIT)


@pytest.mark.parametrize("name", ["python-O0", "python-O1"])
@pytest.mark.parametrize("depth", [19, 22, None], ids=str)
@pytest.mark.parametrize("form", FORMS)
def test_python(form: str, depth: int | None, name: str) -> None:
    depth = depth or deepest(form)
    verdict = judge(TARGETS[name], network(form, depth), None, LIMIT, expected=reference(form, depth))
    assert verdict.result == "equal", verdict.details
    assert verdict.communications > 0, "nothing was compared"


@pytest.mark.parametrize("name", ["python-O0", "python-O1", "python-O1-observed"])
def test_parts_do_the_same(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Programs that are not nested deeply, with a limit so low that Python seems to allow hardly anything in one
    function.
    """
    for limit in ("MOST_BLOCKS", "MOST_LEVELS", "MOST_BRACKETS"):
        monkeypatch.setattr(splitting, limit, 2)
    for path in PROGRAMS[::4]:
        parts = parsed(path)
        for environment in environments(parts):
            verdict = judge(TARGETS[name], parts, environment, LIMIT, path)
            assert verdict.result == "equal", f"{path}: {verdict.details}"
    for seed in range(4):
        for random in (meetings, known):
            assert not difference(str(random(seed)), [name]), f"{random.__name__} {seed}"


@pytest.mark.parametrize("level", [0, 1])
def test_the_linter_is_content(level: int, tmp_path: Path) -> None:
    for form in ("mu", "handler", "mixed", "maximum"):
        files = pipeline.generate(network(form, 60), read, "python", level)
        folder = tmp_path / form
        folder.mkdir()
        for path in ("pyproject.toml", "nested/nested.py"):
            (folder / Path(path).name).write_text(files[path], encoding="utf-8")
    ruff = [sys.executable, "-m", "ruff", "check", "--no-cache", "."]
    done = subprocess.run(ruff, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize("form", FORMS)
def test_c_compiles(form: str, tmp_path: Path) -> None:
    files = pipeline.generate(network(form, deepest(form)), read, "c", 1)
    for path, text in files.items():
        place = tmp_path / path
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_text(text, encoding="utf-8")
    sources = [place for place in tmp_path.rglob("*.c") if "support" not in place.parts]
    includes = {f"-I{place.parent}" for place in tmp_path.rglob("*.h")}
    command = [*find_compiler().command, "-std=c99", "-fsyntax-only", *sorted(includes), *map(str, sources)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("name", ["c-O0", "c-O1"])
def test_c_runs(name: str) -> None:
    verdict = judge(TARGETS[name], network("mixed", 60), None, LIMIT, expected=reference("mixed", 60))
    assert verdict.result == "equal", verdict.details


def test_processes_inside_each_other_have_a_limit() -> None:
    text = nested("instances", deepest("instances") + 1)
    found = pipeline.check(SourceFile(name="nested.csp", text=text), read).report.diagnostics
    errors = [each for each in found if each.code.startswith("E")]
    assert [(each.code, each.span.text) for each in errors] == [("E0103", "P100")]


@pytest.mark.parametrize("form", ["mu", "product"])
def test_no_package_is_written_that_is_not_python(
    form: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A mistake of the generator, provoked here by allowing what Python does not, is found before anything is
    written.
    """
    for limit in ("MOST_BLOCKS", "MOST_LEVELS", "MOST_BRACKETS"):
        monkeypatch.setattr(splitting, limit, 1000)
    program = tmp_path / "nested.csp"
    program.write_text(nested(form, 190), encoding="utf-8")
    assert main(["compile", str(program), "-O1", "-o", str(tmp_path / "build")]) != 0
    assert "internal error" in capsys.readouterr().err
    assert not (tmp_path / "build").exists()
    with pytest.raises(SyntaxError):
        cspdiag.load(program).compile(level=1)
