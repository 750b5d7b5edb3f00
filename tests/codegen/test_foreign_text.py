"""Text from outside — doc comments, strings, lines of the program, names of files — stays text in everything that is
generated.
"""

from __future__ import annotations

import ast
import re
import subprocess
import tomllib
from collections.abc import Mapping
from functools import cache
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from markdown_it import MarkdownIt

from cspdiag import pipeline
from cspdiag.base import SourceFile
from cspdiag.codegen import TARGETS
from cspdiag.codegen.c.text.literals import quoted as c_string
from cspdiag.codegen.python.text.literals import docstring, quoted, remark
from cspdiag.codegen.shared.package_text import markdown, markdown_code, toml_string
from cspdiag.network.ir.network import Network
from cspdiag.simulate.native.build import find_compiler
from tests.codegen.c.test_golden import BUILD
from tests.codegen.hostile import FILE_NAMES, TEXTS, program
from tests.codegen.skeleton import docstrings, skeleton

WAYS = [(target, level) for target in TARGETS for level in (0, 1) if level == 0 or target in {"python", "c"}]


def nothing(path: str) -> SourceFile:
    return SourceFile(name=path, text="")


@cache
def network(text: str, file: str) -> Network:
    built = pipeline.build(SourceFile(name=file, text=program(text, text)), nothing)
    assert built.network is not None, [f"{d.span}: {d.message}" for d in built.checked.report.diagnostics]
    return built.network


def generated(text: str, target: str, level: int, file: str = "project/plain.csp") -> Mapping[str, str]:
    """The files of a package, except those that are the same in every package, without the identity of the build."""
    files = pipeline.generate(network(text, file), nothing, target, level)
    return {
        path: BUILD.sub("", text) for path, text in files.items() if not {"runtime", "support"} & set(path.split("/"))
    }


@cache
def plain(target: str, level: int, file: str = "project/plain.csp") -> dict[str, object]:
    return skeletons(generated("Plain text.", target, level, file))


def skeletons(files: Mapping[str, str]) -> dict[str, object]:
    return {path: skeleton(path, text) for path, text in files.items()}


def assert_readable(files: Mapping[str, str]) -> None:
    """Every file can be written, and shows its contents."""
    for path, text in files.items():
        text.encode()
        assert re.search(r"[^\n\t -\u202d\u202f-\U0010ffff]", text) is None, path


@pytest.mark.parametrize("kind", TEXTS)
@pytest.mark.parametrize(("target", "level"), WAYS)
def test_a_text_changes_nothing_but_texts(target: str, level: int, kind: str) -> None:
    files = generated(TEXTS[kind], target, level)
    assert_readable(files)
    assert skeletons(files) == plain(target, level)


@pytest.mark.parametrize("file", FILE_NAMES)
@pytest.mark.parametrize(("target", "level"), WAYS)
def test_the_name_of_a_file_changes_nothing_but_texts(target: str, level: int, file: str) -> None:
    found = network("Plain text.", f"{file}/{file}")
    files = generated("Plain text.", target, level, f"{file}/{file}")
    assert_readable(files)
    assert skeletons(files) == plain(target, level, f"{found.name}.csp")


@pytest.mark.parametrize("kind", TEXTS)
def test_docstrings_read_back_as_the_doc_comment(kind: str) -> None:
    expected = " ".join(TEXTS[kind].split())
    files = generated(TEXTS[kind], "python", 0)
    for path in (
        "plain/__init__.py",
        "plain/outer.py",
        "plain/inner.py",
        "plain/law.py",
        "plain/environments/bench.py",
    ):
        assert any(expected in " ".join(found.split()) for found in docstrings(files[path])), path
    description = tomllib.loads(files["pyproject.toml"])["project"]["description"]
    assert description.removesuffix(".") == expected.removesuffix(".")


@pytest.mark.parametrize("kind", TEXTS)
def test_a_doc_comment_is_not_markup_in_the_readme(kind: str) -> None:
    expected = " ".join(TEXTS[kind].split())
    parsed = MarkdownIt("commonmark").enable("table").parse(markdown(expected))
    assert [token.type for token in parsed] == ["paragraph_open", "inline", "paragraph_close"]
    inline = parsed[1].children or []
    assert {token.type for token in inline} <= {"text", "code_inline", "text_special"}
    if "`" not in expected and expected.isprintable():
        assert "".join(token.content for token in inline) == expected


@pytest.mark.parametrize("file", FILE_NAMES)
def test_a_code_span_holds_any_name(file: str) -> None:
    (_, inline, _) = MarkdownIt().parse(markdown_code(file))
    assert [token.type for token in inline.children or []] == ["code_inline"]


ANY = st.text(st.characters() | st.sampled_from("\"\\'\n\r\u2028N{x}#*`|_<&\ud800\udcff"))


@given(ANY)
def test_any_string_reads_back_in_python_and_toml(text: str) -> None:
    assert ast.literal_eval(quoted(text)) == text
    whole = "".join("\ufffd" if "\ud800" <= character <= "\udfff" else character for character in text)
    assert tomllib.loads(f"text = {toml_string(text)}\n")["text"] == whole
    assert "".join(f"# {remark(text)}").isprintable()


@given(ANY, st.sampled_from(["", "    "]))
def test_any_docstring_reads_back(text: str, indent: str) -> None:
    whole = "".join("\ufffd" if "\ud800" <= character <= "\udfff" else character for character in f"Begins. {text}")
    rows = docstring(f"Begins. {text}", indent)
    source = "\n".join(["class Of:", *rows] if indent else rows)
    (found,) = docstrings(source)
    assert found.split() == whole.split()


def test_compilers_read_c_strings_as_they_were(tmp_path: Path) -> None:
    texts = [*TEXTS.values(), *FILE_NAMES]
    rows = "".join(f"    puts({c_string(text)}); putchar(0);\n" for text in texts)
    (tmp_path / "strings.c").write_text(f"#include <stdio.h>\nint main(void)\n{{\n{rows}    return 0;\n}}\n")
    compiler = [*find_compiler().command, "-std=c99", "-Wall", "-Wextra", "-Werror", "-o", "strings", "strings.c"]
    subprocess.run(compiler, cwd=tmp_path, check=True)
    reported = subprocess.run([tmp_path / "strings"], capture_output=True, check=True).stdout
    read = [part.removesuffix(b"\n").decode("utf-8", "surrogateescape") for part in reported.split(b"\0")]
    assert read == [*texts, ""]


def test_hostile_packages_in_c_compile(tmp_path: Path) -> None:
    text = "\n".join(TEXTS.values())
    built = pipeline.build(SourceFile(name='a "b"\n/*/x.csp', text=program(text)), nothing)
    assert built.network is not None
    for path, written in pipeline.generate(built.network, nothing, "c", 1).items():
        (tmp_path / path).parent.mkdir(exist_ok=True)
        (tmp_path / path).write_text(written, encoding="utf-8")
    sources = sorted(path.name for path in tmp_path.glob("*.c"))
    flags = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-fsyntax-only", "-DCSP_TRACE=1", "-I.", "-Isupport"]
    subprocess.run([*find_compiler().command, *flags, *sources], cwd=tmp_path, check=True)
