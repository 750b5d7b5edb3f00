"""A compiler runs again whenever something may be different."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from tests.support.compiling import compile_once

pytestmark = pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no gcc")


@pytest.fixture(autouse=True)
def _empty_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


def shown(folder: Path, header: str, *options: str) -> str:
    """What the program prints that is compiled in a folder."""
    (folder / "include" / "more").mkdir(parents=True, exist_ok=True)
    (folder / "include" / "more" / "text.h").write_text(header)
    (folder / "main.c").write_text('#include <stdio.h>\n#include "more/text.h"\nint main(void) { puts(TEXT); }\n')
    compile_once("gcc", *options, f"-I{folder / 'include'}", "-c", "main.c", cwd=folder)
    compile_once("gcc", folder / "main.o", "-o", folder / "program")
    return subprocess.run([folder / "program"], capture_output=True, text=True, check=True).stdout


def entries(tmp_path: Path) -> int:
    return len([*(tmp_path / "cache" / "cspdiag" / "tests").iterdir()])


def test_the_same_is_copied_into_another_folder(tmp_path: Path) -> None:
    for name in ("one", "other"):
        assert shown(tmp_path / name, '#define TEXT "a"') == "a\n"
    assert entries(tmp_path) == 2


def test_another_header_or_option_is_compiled_again(tmp_path: Path) -> None:
    assert shown(tmp_path / "one", '#define TEXT "a"') == "a\n"
    assert shown(tmp_path / "one", '#define TEXT "b"') == "b\n"
    assert shown(tmp_path / "one", "", '-DTEXT="c"') == "c\n"
    assert entries(tmp_path) == 6


def test_what_does_not_compile_is_never_kept(tmp_path: Path) -> None:
    (tmp_path / "wrong.c").write_text("int main(void) { return x; }\n")
    for _ in range(2):
        with pytest.raises(AssertionError, match="undeclared"):
            compile_once("gcc", "wrong.c", "-o", "wrong", cwd=tmp_path)
    assert not (tmp_path / "cache" / "cspdiag" / "tests").exists()
