"""Templates of the user: what they replace, what they are given, and what is reported about mistakes in them."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Callable, Mapping
from pathlib import Path

import jinja2
import pytest

from cspdiag import pipeline
from cspdiag.base.record import field_names, is_record
from cspdiag.cli.main import main
from cspdiag.codegen.c.package.layouts import LAYOUTS, Layout
from cspdiag.codegen.options import FRAMEWORKS
from cspdiag.codegen.shared.render import Replacement, TemplateError, template_names
from cspdiag.network.ir.network import Network
from tests.codegen.packages import network, read

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "targets.md").read_text(encoding="utf-8")
CASCADE = str(ROOT / "models" / "cascade" / "cascade.csp")
TARGETS = {"c": "C", "python": "Python"}
OF_FRAMEWORKS = {name for layout in LAYOUTS.values() for name in layout.manifests.values()}


def section(target: str) -> str:
    return PAGE.split(f"### Templates of {TARGETS[target]}\n")[1].split("\n##")[0]


def documented(target: str) -> dict[str, set[str]]:
    """What each template is given according to the page, to the last field."""
    rows = [[re.findall(r"`([^`]+)`", cell) for cell in row.split(" | ")] for row in section(target).splitlines()]
    values = [row[0][0] for row in rows if len(row) == 2 and row[0]]
    found: dict[str, set[str]] = {}
    for row in rows:
        if len(row) == 3 and row[0]:
            given = row[2]
            parts = {value for value in values for name in given if value.startswith((f"{name}.", f"{name}["))}
            found[row[0][0]] = parts | {name for name in given if name in values}
    return found


def spelled(name: str, value: object) -> set[str]:
    if is_record(value):
        return {part for field in field_names(value) for part in spelled(f"{name}.{field}", getattr(value, field))}
    if isinstance(value, list) and value and is_record(value[0]):
        return {name, *spelled(f"{name}[]", value[0])}
    return {name}


@pytest.fixture
def given(monkeypatch: pytest.MonkeyPatch) -> Mapping[str, set[str]]:
    """What each template was given, by its name, while packages are generated."""
    found: dict[str, set[str]] = defaultdict(set)
    render: Callable[..., str] = jinja2.Template.render

    def spy(template: jinja2.Template, values: Mapping[str, object]) -> str:
        assert template.name is not None
        found[template.name] |= {part for name, value in values.items() for part in spelled(name, value)}
        return render(template, values)

    monkeypatch.setattr(jinja2.Template, "render", spy)
    return found


@pytest.mark.parametrize("target", TARGETS)
def test_the_page_says_what_each_template_is_given(target: str, given: Mapping[str, set[str]]) -> None:
    programs: list[Network] = [network("jiwy"), network("names")]
    if target == "python":
        programs.append(network("hardware"))
    for program in programs:
        for level in (0, 1):
            pipeline.generate(program, read, target, level)
    for framework in FRAMEWORKS if target == "c" else ():
        pipeline.generate(network("jiwy"), read, target, framework=framework)
    assert set(documented(target)) == set(template_names(target))
    assert {name: given[name] for name in template_names(target)} == documented(target)


def replaced(target: str, name: str, text: str) -> dict[str, str]:
    return pipeline.generate(network("cascade"), read, target, templates={name: Replacement(f"own/{name}", text)})


@pytest.mark.parametrize("target", TARGETS)
def test_every_template_can_be_replaced(target: str) -> None:
    plain = pipeline.generate(network("jiwy"), read, target)
    for name in sorted(set(template_names(target)) - OF_FRAMEWORKS):
        own = {name: Replacement(name, f'mine\n{{% include "original/{name}" %}}')}
        found = pipeline.generate(network("jiwy"), read, target, templates=own)
        changed = {path for path in plain if found[path] != plain[path]}
        assert found.keys() == plain.keys()
        assert all(
            found[path].count("mine\n") == 1 and found[path].replace("mine\n", "") == plain[path] for path in changed
        )
        assert changed or name in ("types.py.j2", "external.py.j2"), name


@pytest.mark.parametrize(("framework", "layout"), LAYOUTS.items(), ids=LAYOUTS)
def test_every_manifest_can_be_replaced(framework: str, layout: Layout) -> None:
    for path, name in layout.manifests.items():
        own = {name: Replacement(name, f'mine\n{{% include "original/{name}" %}}')}
        found = pipeline.generate(network("jiwy"), read, "c", templates=own, framework=framework)
        assert found[path].startswith("mine\n")


def test_the_example_of_the_page(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    example = PAGE.split("```jinja\n")[1].split("```")[0]
    folder = tmp_path / "acme"
    folder.mkdir()
    (folder / "source.c.j2").write_text(example)
    (folder / "header.h.j2").write_text(example.replace("source.c", "header.h"))
    assert main(["compile", CASCADE, "--target", "c", "--templates", str(folder), "-o", str(tmp_path / "out")]) == 0
    package = tmp_path / "out" / "cascade"
    for path in package.glob("*.[ch]"):
        first = f"/* Copyright ACME Motion. {path.name} of Cascade, generated from cascade.csp. */\n"
        assert path.read_text().startswith(first)
        assert len(path.read_text()) > len(first) + 100
    assert not (package / "support" / "csp.h").read_text().startswith("/* Copyright ACME")


def test_parts_begin_with_an_underscore(tmp_path: Path) -> None:
    (tmp_path / "Makefile.j2").write_text('{% include "_house.mk" %}\n\n')
    (tmp_path / "_house.mk").write_text("# {{ project.package }}")
    out = ["-o", str(tmp_path / "out")]
    assert main(["compile", CASCADE, "--target", "c", "--templates", str(tmp_path), *out]) == 0
    assert (tmp_path / "out" / "cascade" / "Makefile").read_text() == "# cascade\n"


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("{{ file.nmae }}", "`file` has no `nmae`; it has: name, text, top, source"),
        ("{{ fil.name }}", "`fil` is undefined; the template is given: file"),
        ("{% if %}", "Expected an expression, got 'end of statement block'"),
        ("{{ 1 / 0 }}", "ZeroDivisionError: division by zero"),
        ("{{ file.text | shout }}", "No filter named 'shout'."),
        ('{% include "source.c.j2" %}', "the template includes itself (the one of cspdiag is original/NAME)"),
        ('{% include "other.j2" %}', "there is no template other.j2 to include"),
    ],
)
def test_a_mistake_is_reported_with_its_line(
    text: str, reason: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(TemplateError) as reported:
        replaced("c", "source.c.j2", f"one\n{text}\n")
    assert str(reported.value) == f"own/source.c.j2:2: {reason}"
    path, out = tmp_path / "source.c.j2", tmp_path / "out"
    path.write_text(f"one\n{text}\n")
    assert main(["compile", CASCADE, "--target", "c", "--templates", str(tmp_path), "-o", str(out)]) == 1
    assert capsys.readouterr().err == f"cspdiag: {path}:2: {reason}\n"
    assert not out.exists()


def test_templates_that_produce_invalid_python_write_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    own, out = tmp_path / "own", tmp_path / "out"
    own.mkdir()
    (own / "class.py.j2").write_text("import\n", encoding="utf-8")
    assert main(["compile", CASCADE, "--templates", str(own), "-o", str(out)]) == 1
    message = capsys.readouterr().err
    assert ".py:1: with these templates it is not Python: " in message
    assert not out.exists()


@pytest.mark.parametrize(
    ("name", "content", "reason"),
    [
        (
            "Makefiel.j2",
            b"",
            "is not a template of the target c; there are: CMakeLists.txt.j2, LICENSE.j2, Makefile.j2, ",
        ),
        ("support", None, "is not a template of the target c"),
        ("README.md.j2", None, "is a directory"),
        ("README.md.j2", b"caf\xe9", "is not in UTF-8 (byte 3)"),
    ],
)
def test_a_file_that_is_not_a_template_is_refused(
    name: str, content: bytes | None, reason: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "own" / name
    path.parent.mkdir()
    path.mkdir() if content is None else path.write_bytes(content)
    out = tmp_path / "out"
    assert main(["compile", CASCADE, "--target", "c", "--templates", str(path.parent), "-o", str(out)]) == 2
    reported = capsys.readouterr().err
    assert str(path) in reported
    assert reason in reported
    assert not out.exists()


@pytest.mark.parametrize(
    ("target", "reason"), [("c", "there is no such folder"), ("promela", "is made without templates")]
)
def test_a_folder_that_cannot_be_used(
    target: str, reason: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["compile", CASCADE, "--target", target, "--templates", str(tmp_path / "none")]) == 2
    assert reason in capsys.readouterr().err
