"""Boards on which a program can be simulated instead of this machine: processors that QEMU emulates."""

from __future__ import annotations

import shutil
from collections.abc import Mapping, Sequence

from cspdiag.base.record import record
from cspdiag.simulate.native.build import CompilerError, Toolchain

_SUPPORT = "support/"

_EVERYWHERE = ("-fno-short-enums", "-ffunction-sections", "-fdata-sections")
"""Enumerations have the size that they have on this machine, which reads their values."""


@record
class Board:
    """A processor: how programs for it are built and started. ``sources`` are the files of the kernel for it."""

    name: str
    processor: str
    toolchain: Toolchain
    sources: tuple[str, ...]
    emulator: tuple[str, ...]
    packages: str
    """What has to be installed on Debian and Ubuntu."""

    def require_tools(self) -> None:
        """Raises CompilerError if the compiler or the emulator is not installed."""
        commands = (self.toolchain.command[0], self.emulator[0])
        missing = [command for command in commands if shutil.which(command) is None]
        if missing:
            raise CompilerError(
                f"--on {self.name} needs {' and '.join(missing)} (Debian, Ubuntu: apt install {self.packages})"
            )

    def command(self, program: str, words: Sequence[str]) -> list[str]:
        """The command that runs a program with the words of its command line."""
        line = ",".join(f"arg={word.replace(',', ',,')}" for word in ("program", *words))
        return [
            *self.emulator, *("-display", "none", "-monitor", "none", "-serial", "none"),
            *("-semihosting-config", f"enable=on,target=native,{line}"), "-kernel", program,
        ]  # fmt: skip


def _cortex_m(name: str, processor: str, machine: str, *options: str) -> Board:
    return Board(
        name,
        processor,
        Toolchain(
            command=("arm-none-eabi-gcc",),
            options=("-Os", f"-mcpu={name}", "-mthumb", *options, *_EVERYWHERE),
            libraries=(
                "-nostartfiles",
                "--specs=nosys.specs",
                "-Wl,--gc-sections",
                "-Wl,--no-warn-rwx-segments",
                "-Wl,--no-enum-size-warning",
                "-lm",
            ),
            script=f"{_SUPPORT}csp_port_cortex_m.ld",
        ),
        ("csp_port_board.c", "csp_port_board_cortex_m.c"),
        ("qemu-system-arm", "-machine", machine),
        "gcc-arm-none-eabi libnewlib-arm-none-eabi qemu-system-arm",
    )


_RISCV = Board(
    "riscv32",
    "a 32-bit RISC-V processor",
    Toolchain(
        command=("riscv64-unknown-elf-gcc",),
        options=(
            *("-Os", "-march=rv32imac", "-mabi=ilp32", "--specs=picolibc.specs"),
            *_EVERYWHERE,
        ),
        libraries=("-nostartfiles", "-Wl,--gc-sections", "-Wl,--no-warn-rwx-segments", "-lm"),
        script=f"{_SUPPORT}csp_port_board_riscv.ld",
    ),
    ("csp_port_board.c", "csp_port_board_riscv.c"),
    ("qemu-system-riscv32", "-machine", "virt", "-bios", "none"),
    "gcc-riscv64-unknown-elf picolibc-riscv64-unknown-elf qemu-system-misc",
)

_ALL = (
    _cortex_m("cortex-m0", "the instructions of a Cortex-M0", "mps2-an385"),
    _cortex_m("cortex-m3", "a Cortex-M3", "mps2-an385"),
    _cortex_m("cortex-m4", "a Cortex-M4F", "mps2-an386", "-mfpu=fpv4-sp-d16", "-mfloat-abi=hard"),
    _cortex_m("cortex-m7", "a Cortex-M7", "mps2-an500", "-mfpu=fpv5-d16", "-mfloat-abi=hard"),
    _RISCV,
)

BOARDS: Mapping[str, Board] = {board.name: board for board in _ALL}
"""By name. QEMU has no machine with a Cortex-M0 and enough memory: its instructions run on a Cortex-M3."""
