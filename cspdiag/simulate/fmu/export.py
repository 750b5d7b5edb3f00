"""An FMU as a file: description, sources, documentation, and the binary for this platform."""

from __future__ import annotations

import io
import platform
import sys
import zipfile
from collections.abc import Mapping
from pathlib import Path

from cspdiag.base.errors import CspdiagError
from cspdiag.codegen.fmi.description import COMPILER_OPTIONS
from cspdiag.fmu.platforms import has_name, platform_folder
from cspdiag.simulate.native.build import Build

_SOURCES = "sources/"
_OPTIONS = ("-O2", "-fPIC", "-fvisibility=hidden", COMPILER_OPTIONS)
_BEGINNING = (1980, 1, 1, 0, 0, 0)
"""The date of all files in the archive, so that equal programs make equal FMUs."""


class PlatformError(CspdiagError):
    """FMUs are not made on this platform."""


def archive(files: Mapping[str, str], name: str, fmi: str, documentation: str = "") -> bytes:
    """The FMU of these files, those of the target ``fmu``, compiled for this platform; ``name`` is that of its binary.

    ``documentation`` is a page of HTML. Raises CompilerError and PlatformError.
    """
    if not has_name() or sys.platform == "win32":
        raise PlatformError(
            f"FMUs are made on Linux and macOS for x86-64 and ARM64, and this is {sys.platform} on "
            f"{platform.machine()}; program.compile('fmu') gives the sources"
        )
    folder, suffix = platform_folder(fmi)
    sources = {path.removeprefix(_SOURCES): text for path, text in files.items() if path.startswith(_SOURCES)}
    compiled = [path for path in sources if path.endswith(".c")]
    binary = Build(sources, compiled, _OPTIONS).library()
    pages = {"documentation/index.html": documentation} if documentation else {}
    contents: dict[str, bytes] = {path: text.encode() for path, text in {**files, **pages}.items()}
    contents[f"binaries/{folder}/{name}{suffix}"] = Path(binary).read_bytes()
    return _zip(contents)


def _zip(contents: Mapping[str, bytes]) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archived:
        for path, data in sorted(contents.items()):
            entry = zipfile.ZipInfo(path, _BEGINNING)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = 0o644 << 16
            archived.writestr(entry, data)
    return buffer.getvalue()
