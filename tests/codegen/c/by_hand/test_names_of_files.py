"""The names of files by hand, and of macros in them: those that are taken are refused, all others compile."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

from cspdiag import pipeline
from cspdiag.base.sources import read_source
from cspdiag.codegen.shared.target_error import TargetError
from tests.codegen.c.test_package import needs_compiler, written

PROGRAM = """
const N = 5
submodel LAW(gain: double) c "FILE.c" {
  in  level   : double
  out opening : double
}
process Tank {
  in  level : double @ 10 ms
  out opening : double @ 10 ms
  out q : int
  communication {
    law : LAW(gain = 2)
    var v : int = 0
    level -> law.level
    law.opening -> opening
  }
  composition { mu (law ; v := v + N ; q ! v) }
}
"""
HEADER = """#pragma once
BESIDE
struct STRUCT { double level; double opening; double gain; };
void STRUCT_initialize(struct STRUCT *self, double gain);
void STRUCT_reset(struct STRUCT *self);
void STRUCT_calculate(struct STRUCT *self);
"""


def package(folder: Path, law: str, file: str, beside: str = "", macros: str = "") -> dict[str, str]:
    """The package of a program with a law, whose header may include one beside it, with ``macros``."""
    (folder / "tank.csp").write_text(PROGRAM.replace("LAW", law).replace("FILE", file))
    struct = re.sub(r"(?<=[a-z])(?=[A-Z])", "_", law).lower()
    include = f'#include "{beside}"' if beside else ""
    (folder / f"{file}.h").write_text(HEADER.replace("STRUCT", struct).replace("BESIDE", f"{include}\n{macros}"))
    (folder / f"{file}.c").write_text(f'#include "{file}.h"\n')
    if beside:
        (folder / beside).write_text("#pragma once\n")
    network = pipeline.build(read_source(str(folder / "tank.csp")), read_source).network
    assert network is not None
    return pipeline.generate(network, read_source, "c")


def require_syntax(files: dict[str, str], folder: Path) -> None:
    """All sources compile."""
    written(files, folder)
    sources = [path for path in files if path.endswith(".c") and "/" not in path and not path.startswith("main")]
    command = ["cc", "-std=c99", "-fsyntax-only", "-I.", "-Isupport", *sources]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.stderr == ""


@pytest.mark.parametrize(
    ("law", "file", "beside", "reason"),
    [
        ("Network", "network", "", "the struct of `Network` would be `network`, the name of a generated type"),
        ("TankHooks", "law", "", "the struct of `TankHooks` would be `tank_hooks`, the name of a generated type"),
        ("NetworkNames", "network_names", "", "network_names.c, written by hand, has the name of a generated file"),
        ("Constants", "constants", "", "constants.h, written by hand, has the name of a generated file"),
        ("Law", "law", "tank_api.h", "tank_api.h, written by hand, has the name of a generated file"),
        ("Law", "law", "Tank.h", "Tank.h, written by hand, has the name of a generated file"),
        ("Law", "law", "csp_core.h", "csp_core.h, written by hand, has the name of a file of the kernel"),
        ("Math", "math", "", "math.h, written by hand, has the name of a header of C"),
        ("Law", "law", "features.h", "features.h, written by hand, has the name of a header of C"),
        ("Constants", "law", "", "constants.h, which has the struct of `Constants`, has the name of a gen"),
        (
            "Features",
            "law",
            "",
            "features.h, which has the struct of `Features`, has the name of a header",
        ),
        (
            "Law",
            "Law",
            "",
            "law.h, which has the struct of `Law`, has the name of Law.h, but for capitals",
        ),
    ],
)
def test_names_that_are_taken_are_refused_where_the_program_has_them(
    law: str, file: str, beside: str, reason: str, tmp_path: Path
) -> None:
    with pytest.raises(TargetError) as refused:
        package(tmp_path, law, file, beside)
    assert f"tank.csp:3: {reason}" in str(refused.value)
    assert "\n  help: rename " in str(refused.value)


@needs_compiler
@pytest.mark.parametrize(("law", "file"), [("Law", "control"), ("Port", "port"), ("Queue", "queue")])
def test_other_names_are_free(law: str, file: str, tmp_path: Path) -> None:
    require_syntax(package(tmp_path, law, file), tmp_path / "package")


@pytest.mark.parametrize(
    ("macro", "collision"),
    [
        ("N 5", "the macro `N` would replace a name in `static const int64_t N = 5;` of constants.h"),
        ("level 3", "the macro `level` would replace a name in `csp_sampled_input *level;` of tank.h"),
        ("READS_LEVEL 4", "the macro `READS_LEVEL` would replace a name in "),
        ("state 1", "the macro `state` would replace a name in "),
        ("read_level(x) x", "the macro `read_level` would replace a name in "),
    ],
)
def test_a_macro_that_replaces_a_name_of_the_package_is_refused(macro: str, collision: str, tmp_path: Path) -> None:
    with pytest.raises(TargetError) as refused:
        package(tmp_path, "Law", "law", macros=f"#define {macro}")
    assert f"law.h:3: {collision}" in str(refused.value)
    name = re.split(r"\W", macro)[0]
    assert f"  help: give it another name, such as `LAW_{name.upper()}`, or end it by `#undef {name}`" in str(
        refused.value
    )


def test_an_enumerator_with_the_name_of_a_constant_is_refused(tmp_path: Path) -> None:
    with pytest.raises(TargetError) as refused:
        package(tmp_path, "Law", "law", macros="enum sizes { level,\n N = 5 };")
    assert str(refused.value) == (
        "law.h:4: the enumerator `N` has the name of a constant, `static const int64_t N = 5;` of constants.h\n"
        "  help: give it another name, such as `LAW_N`"
    )


MACROS = """#ifndef LAW_OTHER_H
#define LAW_OTHER_H
#define TAPS 12
#define min(a, b) ((a) < (b) ? (a) : (b))
#define level(x) x
#ifndef M_PI
#define M_PI 3.14
#endif
#define law_reset law_reset_all
#define N 4
#undef N
#if 0
#define opening 4
#endif
#ifdef __cplusplus
#define state 4
#endif
#define gain gain
#endif"""


@needs_compiler
def test_other_macros_are_free(tmp_path: Path) -> None:
    require_syntax(package(tmp_path, "Law", "law", macros=MACROS), tmp_path / "package")
