"""All state of a program is in the memory that its owner gives: there may be several instances."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pytest

from cspdiag import pipeline
from tests.c_kernel.building import HERE, STRICT, need, run
from tests.conformance.sources import network_of, read

PLATFORM = "csp_platform"
"""What belongs to the process of the operating system, or to the machine: which run its handlers stop."""
HOSTED = ("main_", "csp_linear", "csp_port_", "csp_signals", "csp_simulation", "csp_stream", "csp_watch")
PROGRAMS = ("models/jiwy/jiwy.csp", "models/dining/dining.csp", "tests/c_kernel/devices/machine.csp")


def package(folder: Path, program: str, level: int) -> Sequence[Path]:
    """The sources of a program and of the kernel, without what belongs to simulations and platforms."""
    for path, text in pipeline.generate(network_of(read(program)), read, "c", level).items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(text)
    names = sorted(folder.rglob("*.c"))
    return [file for file in names if not file.name.startswith(HOSTED) and "_environment" not in file.name]


@pytest.mark.parametrize("level", [0, 1])
@pytest.mark.parametrize("program", PROGRAMS)
def test_no_object_has_writable_data(program: str, level: int, tmp_path: Path) -> None:
    need("gcc", "nm")
    sources = [path for path in package(tmp_path, program, level) if path.stem != PLATFORM]
    objects = tmp_path / "objects"
    objects.mkdir()
    # Without -fno-pie, tables of constant addresses are relocated at the start and so listed as data.
    includes = (f"-I{tmp_path}", f"-I{tmp_path / 'support'}")
    run("gcc", "-std=c99", "-O1", "-fno-pie", *includes, "-c", *sources, cwd=objects)
    symbols = [line.split() for line in run("nm", "-A", "-P", *sorted(objects.glob("*.o"))).splitlines()]
    assert len(symbols) > 100
    assert [symbol[:3] for symbol in symbols if symbol[2] in "bBdDC"] == []


@pytest.mark.parametrize("sanitizer", ["address,undefined", "thread"])
def test_instances_do_not_touch_each_other(sanitizer: str, tmp_path: Path) -> None:
    need("gcc")
    sources = package(tmp_path, "tests/c_kernel/devices/machine.csp", 0)
    flags = (*STRICT, "-O1", "-g", f"-fsanitize={sanitizer}", "-fno-sanitize-recover=all", "-DCSP_TRACE=0")
    includes = (f"-I{tmp_path}", f"-I{tmp_path / 'support'}")
    kernel = [path for path in sources if path.stem not in (PLATFORM, "csp_run")]
    main, image = HERE / "devices" / "instances.c", tmp_path / "program"
    run("gcc", *flags, *includes, *kernel, main, "-lm", "-pthread", "-o", image)
    alone, other, *rest = run(image).splitlines()
    assert alone == "0: 49 driven, sum 612.5, lamp 1, released 1"
    assert other == "0: 98 driven, sum 9702, lamp 1, released 1"
    assert rest == [alone, other] * 2
