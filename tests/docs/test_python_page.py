"""The page about the Python interface: it has every public name, its examples run, and a strict type checker accepts
them.
"""

from __future__ import annotations

import doctest
import re
import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from types import FunctionType

import pytest

import cspdiag
from cspdiag.draw.missing import MissingToolError

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```pycon\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
EXAMPLES = [example for block in BLOCKS for example in doctest.DocTestParser().get_examples(block)]

GIVEN_OUT = (
    "program", "drawing", "run", "signal", "outcome", "found", "span", "answer", "question", "failing", "report",
    "servo",
    "loops", "loop", "margins",
)  # fmt: skip
"""Variables of the page, with an object of each class whose members are public."""

OF_TUPLES = {"count", "index"}
OF_RECORDS = {"uncompared"}
"""Parameters of a class for `record`, which no user sees."""

NEEDS = {"to_dataframe": "pandas", "to_xarray": "xarray", ".plot(": "matplotlib", "frame": "pandas"}


@pytest.fixture(scope="module")
def session(tmp_path_factory: pytest.TempPathFactory) -> dict[str, object]:
    """The variables of the page, after its examples have run in a folder with the models."""
    try:
        cspdiag.load(ROOT / "models/ring/ring.csp").draw()
    except MissingToolError as problem:
        pytest.skip(str(problem))
    if not any(map(shutil.which, ("cc", "gcc", "clang"))):
        pytest.skip("no C compiler: install gcc or clang")
    folder = tmp_path_factory.mktemp("page")
    (folder / "models").symlink_to(ROOT / "models")
    made: dict[str, object] = {}
    reported: list[str] = []
    runner = doctest.DocTestRunner(verbose=False)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        for block in BLOCKS:
            if any(word in block and find_spec(package) is None for word, package in NEEDS.items()):
                continue
            test = doctest.DocTestParser().get_doctest(
                block, made, "python.md", "docs/python.md", PAGE[: PAGE.index(block)].count("\n")
            )
            runner.run(test, out=reported.append, clear_globs=False)
            made.update(test.globs)
    assert runner.failures == 0, "".join(reported)
    return made


def test_the_examples_run(session: dict[str, object]) -> None:
    assert set(GIVEN_OUT) <= set(session)


def test_every_name_of_the_package_is_in_an_example() -> None:
    code = "".join(example.source for example in EXAMPLES)
    assert [name for name in cspdiag.__all__ if f"cspdiag.{name}" not in code and name != "CspdiagError"] == []
    named = set(re.findall(r"\bcspdiag\.(\w+)", code)) - {"base"}
    assert named <= set(cspdiag.__all__)
    assert named == set(re.findall(r"\bcspdiag\.(\w+)", PAGE)) - {"base"}


@pytest.mark.parametrize("variable", GIVEN_OUT)
def test_every_public_member_is_in_an_example(session: dict[str, object], variable: str) -> None:
    code = "".join(example.source for example in EXAMPLES)
    given = session[variable]
    # The other members of a diagnostic depend on its kind.
    shown = {*dir(cspdiag.Diagnostic), "span", "code", "title"} if isinstance(given, cspdiag.Diagnostic) else dir(given)
    members = {name for name in shown if not name.startswith("_")} - OF_RECORDS
    if isinstance(given, tuple):
        members -= OF_TUPLES
    assert {name for name in members if re.search(rf"\.{name}\b", code) is None} == set()


def test_the_table_of_a_program_has_its_members() -> None:
    table = PAGE.partition("## A program")[2].partition("A setting is")[0]
    rows = set(re.findall(r"^\| `(\w+)", table, re.MULTILINE))
    loaded = cspdiag.parse("process A {}")
    assert rows == {name for name in dir(loaded) if not name.startswith("_")}


def test_the_table_of_exceptions_says_what_they_are() -> None:
    rows = dict(re.findall(r"^\| `cspdiag\.(\w+Error)` \| ([^|]*)\|", PAGE, re.MULTILINE))
    assert set(rows) == {name for name in cspdiag.__all__ if name.endswith("Error")} - {"CspdiagError"}
    for name, bases in rows.items():
        kind = getattr(cspdiag, name)
        own = [base.__name__ for base in kind.__bases__ if base is not cspdiag.CspdiagError]
        assert re.findall(r"`(\w+)`", bases)[:1] == own, name


def test_a_strict_type_checker_accepts_every_example(tmp_path: Path) -> None:
    pytest.importorskip("mypy")
    program = tmp_path / "every_public_name.py"
    program.write_text("".join(example.source for example in EXAMPLES), encoding="utf-8")
    options = ["--strict", "--config-file", str(ROOT / "pyproject.toml"), "--cache-dir", str(ROOT / ".mypy_cache")]
    done = subprocess.run(
        [sys.executable, "-m", "mypy", *options, str(program)], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert (ROOT / "cspdiag" / "py.typed").exists()


@pytest.mark.parametrize("variable", GIVEN_OUT)
def test_public_signatures_have_types(session: dict[str, object], variable: str) -> None:
    for owner in type(session[variable]).__mro__:
        if not owner.__module__.startswith("cspdiag."):
            continue
        assert not [name for name, kind in vars(owner).get("__annotations__", {}).items() if "Any" in str(kind)]
        for name, member in vars(owner).items():
            function = member.fget if isinstance(member, property) else getattr(member, "func", member)
            annotations = getattr(function, "__annotations__", {})
            if not name.startswith("_") and isinstance(function, FunctionType):
                assert "return" in annotations, name
                assert not any("Any" in str(kind) for kind in annotations.values()), name
