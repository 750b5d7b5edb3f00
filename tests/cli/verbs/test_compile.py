from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.cli.conftest import Command

ROOT = Path(__file__).parents[3]
JIWY = ROOT / "models/jiwy/jiwy.csp"


def test_a_package_is_made(cspdiag: Command, good: Path, tmp_path: Path) -> None:
    result = cspdiag("compile", good, "-o", tmp_path / "out")
    assert (result.code, result.out) == (0, "")
    (folder,) = (tmp_path / "out").iterdir()
    assert result.err == f"wrote {folder}\n"
    assert (folder / "pyproject.toml").is_file()
    assert (folder / folder.name / "runtime").is_dir()


@pytest.mark.parametrize("level", ["-O0", "-O1"])
def test_a_package_runs_with_nothing_but_python(cspdiag: Command, tmp_path: Path, level: str) -> None:
    assert cspdiag("compile", level, JIWY, "-o", tmp_path).code == 0
    run = "import sys; sys.path.insert(0, '.'); sys.argv[1:] = ['--for', '50ms']; import jiwy.__main__ as j; j.main()"
    result = subprocess.run(
        [sys.executable, "-I", "-S", "-c", run], cwd=tmp_path / "jiwy", env={}, capture_output=True, text=True
    )
    assert result.returncode == 0, result.stderr
    assert result.stdout.startswith("reached the time limit at 50 ms")


def test_a_program_with_errors_makes_nothing(cspdiag: Command, bad: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    for arguments in ([], ["--emit", "network"], ["--emit", "model"]):
        result = cspdiag("compile", bad, "-o", out, *arguments)
        assert (result.code, result.out) == (1, "")
        assert "1 error" in result.err
    assert not out.exists()


def test_changes_made_by_hand_are_kept(cspdiag: Command, good: Path, tmp_path: Path) -> None:
    assert cspdiag("compile", good, "-o", tmp_path / "out").code == 0
    (network,) = (tmp_path / "out").glob("*/*/network.py")
    network.write_text("mine")
    refused = cspdiag("compile", good, "-o", tmp_path / "out")
    assert refused.code == 2
    assert "network.py" in refused.err
    assert "--force" in refused.err
    assert network.read_text() == "mine"
    assert cspdiag("compile", good, "-o", tmp_path / "out", "--force").code == 0
    assert network.read_text() != "mine"


def _texts(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.parametrize(("first", "second"), [("python", "c"), ("c", "python")])
def test_the_package_for_another_target_stays(cspdiag: Command, tmp_path: Path, first: str, second: str) -> None:
    out = tmp_path / "out"
    assert cspdiag("compile", JIWY, "-o", out, "--target", first).code == 0
    before = _texts(out)
    refused = cspdiag("compile", JIWY, "-o", out, "--target", second)
    assert refused.code == 2
    assert refused.err == (
        f"cspdiag: {out / 'jiwy'} has the package for {first}, and the one for {second} has a README.md too: "
        "give another folder with -o (--force overwrites what both have)\n"
    )
    assert _texts(out) == before
    assert cspdiag("compile", JIWY, "-o", out, "--target", second, "--force").code == 0
    assert before.keys() < _texts(out).keys()


def test_targets_whose_files_have_different_names_share_a_folder(cspdiag: Command, good: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    for target in ("promela", "python", "cspm", "promela", "python"):
        assert cspdiag("compile", good, "-o", out, "--target", target).code == 0
    (folder,) = out.iterdir()
    assert {f"{good.stem}.pml", f"{good.stem}.csp", "pyproject.toml"} < _texts(folder).keys()


def test_replacing_the_package_of_another_program_is_reported(cspdiag: Command, tmp_path: Path) -> None:
    out = tmp_path / "out"
    first, second, moved = (tmp_path / name / "arm.csp" for name in ("first", "second", "moved"))
    for program in (first, second, moved):
        program.parent.mkdir()
    for program in (first, second):
        program.write_text("process Arm { composition { skip } }\n")
        assert (
            cspdiag("compile", program, "-o", out).err
            == ("" if program == first else f"{out / 'arm'} had the package of {first}, which this one replaces\n")
            + f"wrote {out / 'arm'}\n"
        )
    second.rename(moved)
    for _ in range(2):
        assert cspdiag("compile", moved, "-o", out).err == f"wrote {out / 'arm'}\n"


def test_the_same_program_gives_the_same_package(cspdiag: Command, tmp_path: Path) -> None:
    for name, seed in (("first", "1"), ("second", "2")):
        subprocess.run(
            [sys.executable, "-m", "cspdiag", "compile", JIWY, "-o", tmp_path / name],
            env={**os.environ, "PYTHONHASHSEED": seed},
            cwd=ROOT,
            check=True,
            capture_output=True,
        )
    first, second = (
        {
            path.relative_to(tmp_path / name): path.read_bytes()
            for path in (tmp_path / name).rglob("*")
            if path.is_file()
        }
        for name in ("first", "second")
    )
    assert first == second


def test_the_tree_is_printed(cspdiag: Command, good: Path) -> None:
    result = cspdiag("compile", "--emit", "ast", good)
    assert (result.code, result.err) == (0, "")
    assert result.out.startswith("SourceTree")
    assert "ProcessDefinition doc='Hands on what it is given.' @2:1" in result.out
    assert "Read @11:9" in result.out


def test_the_model_is_printed(cspdiag: Command, good: Path) -> None:
    result = cspdiag("compile", "--emit", "model", good)
    assert (result.code, result.err) == (0, "")
    assert "process Relay\n    in given : int\n    out taken : int\n    variable held : int\n" in result.out


def test_the_network_is_printed(cspdiag: Command, good: Path) -> None:
    result = cspdiag("compile", "--emit", "network", good)
    assert (result.code, result.err) == (0, "")
    assert "Relay" in result.out
    assert cspdiag("compile", "--emit", "network", good) == result


def test_the_optimized_network_is_printed(cspdiag: Command, good: Path) -> None:
    plain = cspdiag("compile", "--emit", "network", good).out
    result = cspdiag("compile", "-O1", "--emit", "network", good)
    assert (result.code, result.err) == (0, "")
    assert "Relay" in result.out
    assert result.out != plain
    assert result.out.splitlines()[-1].startswith("// Relay is ")


def test_the_transition_system_is_printed(cspdiag: Command, good: Path) -> None:
    result = cspdiag("compile", "--emit", "lts", good)
    assert (result.code, result.err) == (0, "")
    assert "process Relay {\n  state 0 initial // waits to read given at " in result.out
    assert "    external visible Relay.given -> 1\n" in result.out


def test_the_transition_system_does_not_depend_on_the_hash_seed() -> None:
    printed = [
        subprocess.run(
            [sys.executable, "-m", "cspdiag", "compile", JIWY, "--emit", "lts"],
            env={**os.environ, "PYTHONHASHSEED": seed},
            cwd=ROOT,
            check=True,
            capture_output=True,
        ).stdout
        for seed in ("1", "2")
    ]
    assert printed[0] == printed[1]


@pytest.mark.parametrize(
    ("options", "reported"),
    [
        (["--target", "cobol"], "there are: python"),
        (["--set", "T"], "NAME=VALUE"),
        (["--set", "Tsh=fast"], "Tsh"),
        (["--set", "Tshh=1ms"], "did you mean 'Tsh'?"),
        (["--set", "pan.nothing=1"], "pan.nothing"),
    ],
    ids=repr,
)
def test_impossible_requests_are_reported_in_one_line(
    cspdiag: Command, tmp_path: Path, options: list[str], reported: str
) -> None:
    result = cspdiag("compile", JIWY, "-o", tmp_path / "out", *options)
    assert result.code == 2
    assert reported in result.err
    assert result.err.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_constants_and_parameters_are_set(cspdiag: Command) -> None:
    def network(*options: str) -> str:
        result = cspdiag("compile", "--emit", "network", JIWY, *options)
        assert result.code == 0, result.err
        return result.out

    plain = network()
    assert "10 ms" not in plain
    assert network("--set", "Tsh=10ms") != plain
    assert network("--set", "pan.inertia=2e-3") != plain
    assert network("--set", "pan.inertia=1e-3") == plain


def test_a_hand_written_module_goes_into_the_package(cspdiag: Command, tmp_path: Path) -> None:
    (tmp_path / "twice.py").write_text(
        "class Twice:\n    def calculate(self, given: int) -> int:\n        return 2 * given\n"
    )
    program = tmp_path / "double.csp"
    program.write_text(
        'submodel Twice python "twice.py:Twice" { in given : int out doubled : int }\n'
        "process Doubler {\n  in given : int\n  out doubled : int\n"
        "  communication { twice : Twice given -> twice.given twice.doubled -> doubled }\n"
        "  composition { mu twice }\n}\n"
    )
    result = cspdiag("compile", program, "-o", tmp_path / "out")
    assert result.code == 0, result.err
    assert len(list((tmp_path / "out").rglob("external/twice.py"))) == 1
    (tmp_path / "twice.py").unlink()
    missing = cspdiag("compile", program, "-o", tmp_path / "out")
    assert missing.code == 2
    assert "twice.py" in missing.err


@pytest.mark.parametrize("name", ["math", "typing", "time", "asyncio", "json", "Signal", "class"])
def test_a_package_does_not_take_a_name_of_python(cspdiag: Command, tmp_path: Path, name: str) -> None:
    """``python -m math`` would find another module, and generated code would import itself instead of ``typing``."""
    path = tmp_path / f"{name}.csp"
    path.write_text("process Main { out y : int\n composition { y ! 1 } }\n")
    result = cspdiag("compile", path, "-o", tmp_path)
    package = f"{name.lower()}_"
    assert result.err.splitlines() == [
        f"`{name.lower()}` is already used by Python, so the package is called `{package}`; it takes its name "
        "from the file",
        f"wrote {tmp_path / package}",
    ]
    if name in {"typing", "Signal"}:
        run = subprocess.run(
            [sys.executable, "-m", package], cwd=tmp_path / package, capture_output=True, text=True, check=False
        )
        assert run.stderr == f"{package} has no environment; build its network with drivers for y\n"
        assert not (tmp_path / package / name.lower()).exists()


@pytest.mark.parametrize(
    ("name", "package"),
    [
        ("\u00fcn\u00ef", "ueni"),
        ("u\u0308ni\u0308", "ueni"),
        ("\u00e4n\u00e4", "aenae"),
        ("\u03c9-loop", "omega_loop"),
        ("1 2", "main"),
        ("\u65e5", "main"),
        ("a'b\"c $x", "a_b_c__x"),
    ],
)
@pytest.mark.parametrize("target", ["c", "python"])
def test_a_package_that_cannot_be_called_after_its_file_says_so(
    cspdiag: Command, tmp_path: Path, name: str, package: str, target: str
) -> None:
    path = tmp_path / f"{name}.csp"
    path.write_text("process Main { out y : int\n composition { y ! 1 } }\n")
    result = cspdiag("compile", path, "--target", target, "-o", tmp_path)
    said = f"`{name}`, the name of the file, is no identifier, so the package is called `{package}`"
    assert result.err.splitlines()[:2] == [said, f"wrote {tmp_path / package}"]


def test_a_package_that_replaces_that_of_a_neighbour_says_so(cspdiag: Command, tmp_path: Path) -> None:
    for name in ("\u00e9", "\u00e8", "E"):
        (tmp_path / f"{name}.csp").write_text("process Main { out y : int\n composition { y ! 1 } }\n")
    said = [
        cspdiag("compile", tmp_path / f"{name}.csp", "--target", "c", "-o", tmp_path).err.splitlines()[0]
        for name in ("\u00e9", "\u00e8", "E")
    ]
    package = tmp_path / "e"
    assert said == [
        "`\u00e9`, the name of the file, is no identifier, so the package is called `e`",
        f"{package} had the package of {tmp_path / chr(0xE9)}.csp, which this one replaces",
        f"{package} had the package of {tmp_path / chr(0xE8)}.csp, which this one replaces",
    ]


def test_a_header_of_c_is_not_displaced(cspdiag: Command, tmp_path: Path) -> None:
    """The folder of a C package is searched for ``<math.h>`` too."""
    names = ["Math", "String", "Limits", "Stdio", "Time", "Signal", "Errno", "Fcntl", "Unistd", "Stdint", "Pthread"]
    laws = "".join(f"submodel {name} {{ in x : double\n out y : double\n y = x }}\n" for name in names)
    boxes = "".join(f"b{name} : {name}\n x -> b{name}.x\n b{name}.y -> _\n" for name in names)
    order = " ; ".join(f"b{name}" for name in names)
    text = f"process Main {{ in x : double @ 1 ms\n communication {{ {boxes} }}\n composition {{ mu ({order}) }} }}"
    (tmp_path / "main.csp").write_text(laws + text)
    assert cspdiag("compile", "--target", "c", tmp_path / "main.csp", "-o", tmp_path / "out").code == 0
    package = tmp_path / "out" / "main"
    included = {
        header
        for path in package.rglob("*.[ch]")
        for header in re.findall(r"#include <([a-z0-9]+\.h)>", path.read_text())
    }
    assert {"math.h", "stdint.h"} <= included
    assert not included & {path.name for path in package.rglob("*.h")}
