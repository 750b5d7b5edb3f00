"""Names that the generators change must not become the name of something else beside them."""

import shutil
import subprocess
from pathlib import Path

import pytest

import cspdiag
from cspdiag.codegen.c.text.names import member_name
from tests.codegen.names.test_nasty_names import allowed_as_constants, names_in_functions

PAIRS = [
    ("class", "class_"),
    ("class_", "class__"),
    ("__a", "x__a"),
    ("_b", "underscore_b"),
    ("csp_run", "xcsp_run"),
    ("self", "self_"),
    ("aB", "a_b"),
]
PROGRAM = """
struct S {{
  {one} : double
  {two} : int
}}
enum M {{ begin, {one}, {two} }}

submodel Law({one} : double, {two} : double) {{
  out o : double
  o = {one} - {two}
}}

process Inner({one}_given : int) {{
  out {one} : int
  out {two} : double
  composition {{ {one} ! 1 || {two} ! 2.5 }}
}}

process Top {{
  out {one} : int
  out {two} : double
  out s : S
  out m : M
  out n : M
  out o : double
  communication {{
    law : Law({one} = 7, {two} = 4)
    inner : Inner({one}_given = 3)
    law.o -> o
    inner.{one} -> {one}
    inner.{two} -> {two}
  }}
  composition {{
    law ; inner ; s ! S({one} = 1.5, {two} = 2) ; m ! M.{one} ; n ! M.{two}
  }}
}}

environment Bench for Top {{
  {one} -> _
  {two} -> _
  s -> _
  m -> _
  n -> _
  o -> _
}}
"""


def test_two_names_are_never_the_same_member() -> None:
    stems = ["a", "class", "int", "csp_run", "csp", "errno", "x", "x_ref", "underscore_b", "EOF", "self", "xcsp_a"]
    names = {
        f"{before}{stem}{after}"
        for stem in stems
        for before in ("", "_", "__", "x", "xx", "x_", "x__", "underscore_", "xunderscore_")
        for after in ("", "_", "__")
    }
    assert len({member_name(name) for name in names}) == len(names)


@pytest.mark.parametrize(("one", "two"), PAIRS)
def test_values_go_to_the_right_one(one: str, two: str, tmp_path: Path) -> None:
    file = tmp_path / "pair.csp"
    file.write_text(PROGRAM.format(one=one, two=two))
    program = cspdiag.load(file)
    expected = program.run(until="1 ms", level="reference")
    for target in ("python", "c") if shutil.which("gcc") else ("python",):
        for level in (0, 1):
            run = program.run(until="1 ms", target=target, level=level)
            for port in (one, two, "s", "m", "n", "o"):
                assert str(run[port]) == str(expected[port]), (target, level, port)


def test_names_may_be_longer_than_those_of_files(tmp_path: Path) -> None:
    first, second = "P" + "p" * 298 + "a", "P" + "p" * 298 + "b"
    inner = "process {name} {{\n  out o : int\n  composition {{ o ! {value} }}\n}}\n"
    outer = (
        f"process Top {{\n  out a : int\n  out b : int\n  communication {{\n    one : {first}\n    two : {second}\n"
        "    one.o -> a\n    two.o -> b\n  }\n  composition { one ; two }\n}\n"
        f"environment {first}Bench for Top {{\n  a -> _\n  b -> _\n}}\n"
    )
    text = inner.format(name=first, value=1) + inner.format(name=second, value=2) + outer
    file = tmp_path / "long.csp"
    file.write_text(text)
    program = cspdiag.load(file)
    for target in ("python", "c") if shutil.which("gcc") else ("python",):
        for level in (0, 1):
            paths = program.compile(target, level=level)
            assert max(len(part) for path in paths for part in path.split("/")) < 200
            run = program.run(until="1 ms", target=target, level=level)
            assert 1 in [*run["a"]], (target, level)
            assert 2 in [*run["b"]], (target, level)


@pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no C compiler")
@pytest.mark.parametrize("level", [0, 1])
def test_no_local_variable_hides_a_constant(level: int, tmp_path: Path) -> None:
    names = allowed_as_constants({*names_in_functions()})
    total = " + ".join(f"({' + '.join(names[start : start + 40])})" for start in range(0, len(names), 40))
    text = "".join(f"const {name} = 1.0\n" for name in names)
    text += f"process Q {{ out q : double  composition {{ q ! {total} }} }}\nenvironment B for Q {{ q -> _ }}\n"
    (tmp_path / "constants.csp").write_text(text)
    files = cspdiag.load(tmp_path / "constants.csp").compile("c", level=level)
    for path, made in files.items():
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_text(made)
    sources = [path for path in files if path.endswith(".c") and "support" not in path]
    folders = [f"-I{tmp_path / folder}" for folder in {str(Path(path).parent) for path in files}]
    command = ["gcc", "-std=c99", "-fsyntax-only", "-Wshadow", "-Werror", *folders, *sources]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.stderr == ""
