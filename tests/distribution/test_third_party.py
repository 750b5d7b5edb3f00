"""Third-party files are fetched once, verified, and installed whole or not at all."""

from __future__ import annotations

import importlib.util
import io
import sys
import tarfile
from base64 import b64encode
from hashlib import sha512
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture
def third_party(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> ModuleType:
    """The script without npm, with one package to fetch, ``tool 1.0``, from a folder next to it."""
    spec = importlib.util.spec_from_file_location("third_party", ROOT / "distribution" / "third_party.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, "third_party", module)
    spec.loader.exec_module(module)
    archive = archived({"package/lib/tool.js": b"tool", "package/LICENSE": b"licence"})
    (tmp_path / "tool-1.0.tgz").write_bytes(archive)
    package = module.Package(
        "tool", "1.0", checksum(archive), {"lib/tool.js": "tool/tool.js", "LICENSE": "tool/LICENSE"}
    )
    monkeypatch.setattr(module, "PACKAGES", (package,))
    monkeypatch.setattr(module.shutil, "which", lambda _: None)
    return module


def archived(files: dict[str, bytes]) -> bytes:
    data = io.BytesIO()
    with tarfile.open(fileobj=data, mode="w:gz") as archive:
        for name, content in files.items():
            member = tarfile.TarInfo(name)
            member.size = len(content)
            archive.addfile(member, io.BytesIO(content))
    return data.getvalue()


def checksum(data: bytes) -> str:
    return b64encode(sha512(data).digest()).decode()


def test_files_and_their_licence_come_out_of_a_verified_archive(third_party: ModuleType, tmp_path: Path) -> None:
    folder = tmp_path / "third-party"
    third_party.fetch(folder)
    assert (folder / "tool" / "tool.js").read_bytes() == b"tool"
    assert (folder / "tool" / "LICENSE").read_bytes() == b"licence"
    assert [path.name for path in tmp_path.iterdir() if path.is_dir()] == ["third-party"]


def test_existing_files_are_not_fetched_again(third_party: ModuleType, tmp_path: Path) -> None:
    folder = tmp_path / "third-party"
    third_party.fetch(folder)
    (tmp_path / "tool-1.0.tgz").unlink()
    third_party.fetch(folder)
    (folder / "tool" / "tool.js").unlink()
    with pytest.raises(third_party.FetchError, match=r"npm is not installed: install it, or put tool-1\.0\.tgz into"):
        third_party.fetch(folder)


def test_an_archive_that_differs_is_refused_and_changes_nothing(third_party: ModuleType, tmp_path: Path) -> None:
    folder = tmp_path / "third-party"
    third_party.fetch(folder)
    (folder / "tool" / "LICENSE").unlink()
    (tmp_path / "tool-1.0.tgz").write_bytes(archived({"package/lib/tool.js": b"other"}))
    with pytest.raises(third_party.FetchError, match="its checksum differs"):
        third_party.fetch(folder)
    assert (folder / "tool" / "tool.js").read_bytes() == b"tool"
    assert [path.name for path in tmp_path.iterdir() if path.is_dir()] == ["third-party"]


def test_versions_are_fixed_and_every_package_brings_its_licence() -> None:
    spec = importlib.util.spec_from_file_location("fixed", ROOT / "distribution" / "third_party.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["fixed"] = module
    spec.loader.exec_module(module)
    for package in module.PACKAGES:
        assert package.version[0].isdigit()
        assert any("LICENSE" in place for place in package.files.values())
        assert package.name.rpartition("/")[2] in (ROOT / "LICENSE").read_text().lower()
