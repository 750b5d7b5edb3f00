"""How much flash a program takes, without what it does not use: the smallest firmware of models, for Cortex-M0 and
Cortex-M4F, as linked.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from cspdiag import pipeline
from cspdiag.base.sources import read_source
from tests.c_kernel.building import HERE, need, run
from tests.support.compiling import compile_once

MODELS = HERE.parents[1] / "models"
PROCESSORS = {
    "cortex-m0": ("-mcpu=cortex-m0", "-mthumb"),
    "cortex-m4": ("-mcpu=cortex-m4", "-mthumb", "-mfpu=fpv4-sp-d16", "-mfloat-abi=hard"),
}
SMALL = ("-Os", "-ffunction-sections", "-fdata-sections")
WHOLE = ("-flto",)
"""The compiler sees the whole image when it generates the machine code, as in `examples/c/bare_metal`."""
HOOKS = {"SAMPLE": "(*sample)", "ACTUATE": "(*actuate)", "LOCK": "/* Around accesses"}
"""What in the interface shows that a program has a hook."""
PORT = ("csp_port_cortex_m.c", "csp_port_cortex_m_startup.c", "csp_platform.c")
OF_THE_LIBRARY = re.compile(
    r"^_?(v?s?n?printf(_r)?|_?svf?n?i?printf_r|strto[dl](_r)?|_?(m|c|re)alloc(_r)?|_sbrk|free)$"
)
"""What prints, reads numbers, or needs a heap."""


def library_of(model: str, level: int, processor: str, folder: Path, *options: str) -> Path:
    """The library of the program."""
    network = pipeline.build(read_source(str(MODELS / model)), read_source).network
    assert network is not None
    package = Path(model).stem
    files = pipeline.generate(network, read_source, "c", level)
    for path, text in files.items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(text, encoding="utf-8")
    flags = (*PROCESSORS[processor], *SMALL, *options)
    run(
        "make",
        "-s",
        "-j2",
        "-C",
        folder,
        "CROSS_COMPILE=arm-none-eabi-",
        f"CFLAGS={' '.join(flags)}",
        f"lib{package}.a",
    )
    return folder / f"lib{package}.a"


def linked(library: Path, processor: str, *options: str | Path) -> Path:
    """The program between registers in a superloop, with port and start-up code."""
    folder, package = library.parent, library.stem.removeprefix("lib")
    interface = (folder / f"{package}_api.h").read_text(encoding="utf-8")
    used = [name for name, declaration in HOOKS.items() if declaration in interface]
    support, image = folder / "support", folder / "program.elf"
    compile_once(
        *("arm-none-eabi-gcc", *PROCESSORS[processor], *SMALL, "-std=c99", "-Wall", "-Wextra", "-Werror"),
        *(f"-DPACKAGE={package}", f'-DAPI_HEADER="{package}_api.h"', *(f"-DHAS_{name}" for name in used)),
        *(f"-I{folder}", f"-I{support}", *options, HERE / "cortex_m" / "smallest.c"),
        *(*(support / name for name in PORT), library),
        *("-nostartfiles", "--specs=nosys.specs", "-Wl,--gc-sections", "-Wl,--no-warn-rwx-segments"),
        *("-T", support / "csp_port_cortex_m.ld", "-lm", "-o", image),
    )
    return image


def flash(image: Path) -> int:
    """The bytes of code, constants and initial values."""
    text, data = run("arm-none-eabi-size", image).splitlines()[1].split()[:2]
    return int(text) + int(data)


def of_the_library(image: Path) -> list[str]:
    """The functions of the C library that firmware does without."""
    names = (line.split()[-1] for line in run("arm-none-eabi-nm", image).splitlines())
    return [name for name in names if OF_THE_LIBRARY.match(name)]


@pytest.mark.parametrize(
    ("model", "level", "processor", "options", "bound"),
    [
        ("dining/dining.csp", 1, "cortex-m0", (), 5_800),
        ("dining/dining.csp", 1, "cortex-m0", WHOLE, 4_800),
        ("cascade/cascade.csp", 1, "cortex-m0", (), 12_600),
        ("cascade/cascade.csp", 1, "cortex-m0", WHOLE, 11_400),
        ("cascade/cascade.csp", 1, "cortex-m4", (), 11_100),
        ("cascade/cascade.csp", 1, "cortex-m4", WHOLE, 9_900),
        ("jiwy/jiwy.csp", 0, "cortex-m0", (), 25_800),
        ("jiwy/jiwy.csp", 0, "cortex-m0", WHOLE, 24_000),
        ("jiwy/jiwy.csp", 0, "cortex-m4", (), 22_000),
        ("jiwy/jiwy.csp", 0, "cortex-m4", WHOLE, 20_000),
    ],
)
def test_flash(model: str, level: int, processor: str, options: tuple[str, ...], bound: int, tmp_path: Path) -> None:
    """On a Cortex-M0 5 to 6 kB of the programs that compute in `double` are its arithmetic, of libgcc."""
    need("arm-none-eabi-gcc", "make")
    library = library_of(model, level, processor, tmp_path, *options)
    image = linked(library, processor, *options)
    assert flash(image) <= bound
    assert of_the_library(image) == []
    if model.startswith("jiwy"):
        # Nor do texts, which are written only if the program asks for them.
        sources = ("csp_arithmetic.c", "csp_fault_text.c")
        texts = ("-DCSP_USES_TEXTS=1", "-DDESCRIBES", *(tmp_path / "support" / name for name in sources))
        assert of_the_library(linked(library, processor, *options, *texts)) == []
