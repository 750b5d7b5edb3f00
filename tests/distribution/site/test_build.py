"""Some pages of the site, built by Sphinx. ``make site`` builds all of them."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from distribution.site.contents import KEYWORDS, Entry
from distribution.site.highlighting import CspLexer
from distribution.site.links import complaints
from distribution.site.stage import Site

CONFIGURATION = Path(__file__).parents[3] / "distribution" / "site" / "sphinx"


def test_programs_are_highlighted_by_the_scanner_of_the_language() -> None:
    pytest.importorskip("pygments")
    program = 'import "a.csp"\n\n/// Doc.\nprocess A {\n  in x : double<m/s> @ 1 ms // é\n}\n'
    tokens = list(CspLexer().get_tokens(program))
    assert "".join(text for _, text in tokens) == program
    kinds = {text.strip(): str(kind) for kind, text in tokens}
    assert kinds["process"] == "Token.Keyword"
    assert kinds["/// Doc."] == "Token.Literal.String.Doc"


def test_pages_are_built_without_warnings_and_without_dead_links(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("sphinx", reason="needs Sphinx: make site installs it, or pip install 'cspdiag[site]'")
    pytest.importorskip("furo", reason="needs furo: make site installs it, or pip install 'cspdiag[site]'")
    from sphinx.cmd.build import build_main

    monkeypatch.setitem(KEYWORDS, "semantics", "gain margin, rendezvous")
    site = Site(tmp_path / "sources", tmp_path / "work")
    page = site.page(Entry("docs/semantics.md", "semantics", "", ""))
    site.save("semantics.md", re.sub(r"\]\((?!#)[^)]*\)", "](#time)", page))
    site.save("index.md", "# A\n\n```{toctree}\nsemantics\n```\n\n```csp\nprocess A {}\n```\n")
    options = ["-W", "-q", "-b", "html", "-c", str(CONFIGURATION), "-d", str(tmp_path / "trees")]
    assert build_main([*options, str(tmp_path / "sources"), str(tmp_path / "site")]) == 0
    found = [line for line in complaints(tmp_path / "site") if "playground" not in line and "#time" not in line]
    assert found == []
    index = (tmp_path / "site" / "searchindex.js").read_text(encoding="utf-8")
    (searched,) = re.findall(r'"?indexentries"?:\{([^}]*)\}', index)
    assert re.findall(r'"?([\w ]+)"?:\[\[', searched) == ["gain margin", "rendezvous"]
    assert '<span class="k">process</span>' in (tmp_path / "site" / "index.html").read_text(encoding="utf-8")
