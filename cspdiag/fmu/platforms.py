"""What FMI calls the platform of this machine."""

from __future__ import annotations

import platform
import sys

_MACHINES = {"x86_64": "x86_64", "amd64": "x86_64", "aarch64": "aarch64", "arm64": "aarch64"}
_SYSTEMS = {"linux": ("linux", ".so"), "darwin": ("darwin", ".dylib"), "win32": ("windows", ".dll")}
_OLD_NAMES = {"x86_64-linux": "linux64", "x86_64-darwin": "darwin64", "x86_64-windows": "win64"}
"""What FMI 2.0 calls platforms; it has no names for others, which keep those of FMI 3.0."""


def has_name() -> bool:
    """Whether FMI has a name for this platform."""
    return sys.platform in _SYSTEMS and platform.machine().lower() in _MACHINES


def platform_folder(version: str) -> tuple[str, str]:
    """The folder of binaries for this machine in an FMU for this version of FMI, and the suffix of their names; made of
    the names that Python has where FMI has none.
    """
    system, suffix = _SYSTEMS.get(sys.platform, (sys.platform, ".so"))
    machine = _MACHINES.get(platform.machine().lower(), platform.machine().lower())
    name = f"{machine}-{system}"
    return (_OLD_NAMES.get(name, name) if version == "2.0" else name), suffix
