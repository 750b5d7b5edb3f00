"""Headers that options of the compiler name, outside of the package."""

import shutil
import subprocess
from pathlib import Path

import pytest

from cspdiag.simulate.native.build import Build

MAIN = '#include <stdio.h>\n#include <gain.h>\nint main(void) { return printf("%d", GAIN) < 0; }\n'


@pytest.mark.skipif(shutil.which("cc") is None, reason="there is no C compiler")
@pytest.mark.parametrize("option", ["-I", "-isystem "])
def test_a_header_elsewhere_that_has_changed_is_compiled_again(
    option: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.setenv("CFLAGS", f"{option}{tmp_path / 'elsewhere'}")
    results = []
    for gain in (2, 3, 2):
        (tmp_path / "elsewhere" / "gain.h").write_text('#include "value.h"\n#define GAIN VALUE\n')
        (tmp_path / "elsewhere" / "value.h").write_text(f"#define VALUE {gain}\n")
        program = Build({"main.c": MAIN}, ["main.c"], folder=tmp_path / "cache").executable()
        results.append(subprocess.run([program], capture_output=True, text=True, check=True).stdout)
    assert results == ["2", "3", "2"]
