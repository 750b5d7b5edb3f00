"""Fetches third-party files that cspdiag ships: the layout engine elkjs, and the typefaces of PNG and PDF.

    python distribution/third_party.py

puts them into ``third-party/``, each with its licence, unless they are already there. They come through npm, in fixed
versions whose checksums are verified; wheels contain them, so users of a wheel need neither npm nor a network. Uses
only the standard library.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tarfile
import tempfile
from base64 import b64encode
from dataclasses import dataclass
from hashlib import sha512
from pathlib import Path

FOLDER = Path(__file__).resolve().parent.parent / "third-party"
STAMP = "VERSIONS"
"""Lists what is in the folder; written last."""


class FetchError(Exception):
    """Something could not be fetched; the text is one line."""


@dataclass(frozen=True)
class Package:
    """A package in one version; ``integrity`` is the Base64 of its archive's SHA-512, ``files`` maps files in it to
    places in the folder.
    """

    name: str
    version: str
    integrity: str
    files: dict[str, str]

    @property
    def archive(self) -> str:
        """The name that npm gives the archive."""
        return f"{self.name.lstrip('@').replace('/', '-')}-{self.version}.tgz"


PACKAGES = (
    Package(
        "elkjs",
        "0.12.1",
        "IhMYKHE4S2vtx0QrhBP3lYOIKDeIiJXBrdq9MGYkuB8ZHqhrBnHNfSUndjXFewrX1CPK8chwq+2NA0K0hliYuw==",
        {"lib/elk-worker.min.js": "elkjs/elk-worker.min.js", "LICENSE.md": "elkjs/LICENSE.md"},
    ),
    Package(
        "@expo-google-fonts/arimo",
        "0.4.3",
        "kXMUJ303nJgKjJFr8yuiAY9dgIoAoj9HccKkaSw0J63/T4MSdxFejzfDUVLzUz+ohpQWinifV99QOAUQLcGKDg==",
        {
            "400Regular/Arimo_400Regular.ttf": "fonts/Arimo-Regular.ttf",
            "700Bold/Arimo_700Bold.ttf": "fonts/Arimo-Bold.ttf",
            "400Regular_Italic/Arimo_400Regular_Italic.ttf": "fonts/Arimo-Italic.ttf",
            "LICENSE_FONT": "fonts/LICENSE-Arimo",
        },
    ),
    Package(
        "@expo-google-fonts/cousine",
        "0.4.3",
        "rSl8RXKqxwz8xJvedqdiKtPghSwRAl5c+lMecDyZ1L+V+IQEx6mavMnYkO0KuKgNcHekJXwXZsbmv7zJWggmAw==",
        {"400Regular/Cousine_400Regular.ttf": "fonts/Cousine-Regular.ttf", "LICENSE_FONT": "fonts/LICENSE-Cousine"},
    ),
)


def fetch(folder: Path = FOLDER) -> None:
    """Put everything into ``folder``, or leave it alone if it is complete. Raises FetchError, having changed
    nothing.
    """
    versions = "".join(f"{package.name} {package.version} {package.integrity}\n" for package in PACKAGES)
    stamp = folder / STAMP
    places = [folder / place for package in PACKAGES for place in package.files.values()]
    if stamp.is_file() and stamp.read_text() == versions and all(place.is_file() for place in places):
        return
    folder.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="third-party-", dir=folder.parent) as made:
        staging = Path(made) / "complete"
        for package in PACKAGES:
            _unpack(package, _archive(package, folder, Path(made)), staging)
        (staging / STAMP).write_text(versions)
        if folder.exists():
            os.replace(folder, Path(made) / "previous")
        os.replace(staging, folder)


def _archive(package: Package, folder: Path, scratch: Path) -> bytes:
    """The archive of a package: one that was put next to the folder, or npm's."""
    given = folder.parent / package.archive
    if not given.is_file():
        given = _packed(package, scratch)
    data = given.read_bytes()
    if b64encode(sha512(data).digest()).decode() != package.integrity:
        raise FetchError(f"{package.archive} is not the file that was expected: its checksum differs")
    return data


def _packed(package: Package, scratch: Path) -> Path:
    npm = shutil.which("npm")
    if npm is None:
        raise FetchError(f"npm is not installed: install it, or put {package.archive} into {FOLDER.parent}")
    requested = f"{package.name}@{package.version}"
    try:
        done = subprocess.run([npm, "pack", requested], cwd=scratch, capture_output=True, text=True, timeout=120)
    except subprocess.TimeoutExpired:
        raise FetchError(f"npm pack {requested} does not answer: is there a network?") from None
    if done.returncode != 0:
        reasons = [line for line in done.stderr.splitlines() if "error" in line.lower()]
        raise FetchError(f"npm pack {requested} failed: {reasons[0] if reasons else 'without a reason'}")
    return scratch / package.archive


def _unpack(package: Package, data: bytes, staging: Path) -> None:
    from io import BytesIO

    with tarfile.open(fileobj=BytesIO(data)) as archive:
        for name, place in package.files.items():
            content = archive.extractfile(f"package/{name}")
            if content is None:
                raise FetchError(f"{package.archive} has no file {name}")
            target = staging / place
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(content.read())


if __name__ == "__main__":
    try:
        fetch()
    except (FetchError, OSError) as problem:
        sys.exit(f"cspdiag draw will not work yet: {problem}. Everything else does; `make setup` tries again.")
