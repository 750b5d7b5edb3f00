"""No header of a package is called like one that a C library or a compiler includes itself, which it would hide."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

from cspdiag import pipeline
from cspdiag.base import SourceFile
from cspdiag.codegen.c.text.reserved import is_header
from tests.codegen.packages import read

FOLDERS = {
    "newlib": ("/usr/lib/arm-none-eabi/include", "/usr/include/newlib"),
    "picolibc": tuple(map(str, Path("/usr/lib/picolibc").glob("*/include"))),
    "gcc": tuple(map(str, Path("/usr/lib/gcc").glob("*/*/include"))),
    "clang": tuple(map(str, Path("/usr/lib").glob("llvm-*/lib/clang/*/include"))),
}
"""Where these are installed on Debian, from whose packages (and from musl) the list is taken."""
CLASSES = ("Features", "Newlib", "Math", "Picolibc", "Immintrin", "Task")


def installed(library: str) -> set[str]:
    """The names of the headers of a C library or a compiler on this machine that a process may have."""
    if library == "glibc":
        try:
            done = subprocess.run(["dpkg", "-L", "libc6-dev"], capture_output=True, text=True, check=False)
        except FileNotFoundError:
            return set()
        paths = re.findall(r"^/usr/include/(?:\w+-linux-gnu/)?([^/]+)\.h$", done.stdout, re.MULTILINE)
    else:
        paths = [path.stem for folder in FOLDERS[library] for path in Path(folder).glob("*.h")]
    return {name for name in paths if re.fullmatch(r"[a-z][a-z0-9_]*", name)}


@pytest.mark.parametrize("library", ["glibc", *FOLDERS])
def test_all_headers_are_known(library: str) -> None:
    found = installed(library)
    if not found:
        pytest.skip(f"{library} is not installed")
    assert {name for name in found if not is_header(name)} == set()


def test_headers_of_classes_and_programs_hide_none() -> None:
    classes = "\n".join(f"process {name} {{ composition {{ skip }} }}" for name in CLASSES)
    instances = "\n".join(f"    p{number} : {name}" for number, name in enumerate(CLASSES))
    running = " || ".join(f"p{number}" for number in range(len(CLASSES)))
    text = f"{classes}\nprocess Top {{\n  communication {{\n{instances}\n  }}\n  composition {{ {running} }}\n}}\n"
    built = pipeline.build(SourceFile(name="nl.csp", text=text), read)
    assert built.network is not None
    headers = {path[:-2] for path in pipeline.generate(built.network, read, "c") if path.endswith(".h")}
    assert {"features_2", "newlib_2", "nl__types", "nl__api"} <= headers
    assert [name for name in headers if is_header(name)] == []
