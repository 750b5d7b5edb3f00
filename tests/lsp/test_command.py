from __future__ import annotations

import sys

import pytest

from cspdiag.cli.main import main


def test_without_the_package_the_extra_is_named(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in [name for name in sys.modules if name.split(".")[0] == "pygls" or name.startswith("cspdiag.lsp")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "pygls", None)
    assert main(["lsp"]) == 2
    assert capsys.readouterr().err == "cspdiag: this needs pygls: pip install 'cspdiag[lsp]'\n"
