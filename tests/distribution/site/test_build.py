"""Some pages of the site, built by Sphinx. ``make site`` builds all of them."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from distribution.site.contents import KEYWORDS, Entry
from distribution.site.highlighting import CspLexer
from distribution.site.links import complaints
from distribution.site.stage import Site
from tests.studio.test_page import CHROMIUM, FOLDER, has_packages

CONFIGURATION = Path(__file__).parents[3] / "distribution" / "site" / "sphinx"


def test_programs_are_highlighted_by_the_scanner_of_the_language() -> None:
    pytest.importorskip("pygments")
    program = 'import "a.csp"\n\n/// Doc.\nprocess A {\n  in x : double<m/s> @ 1 ms // é\n}\n'
    tokens = list(CspLexer().get_tokens(program))
    assert "".join(text for _, text in tokens) == program
    kinds = {text.strip(): str(kind) for kind, text in tokens}
    assert kinds["process"] == "Token.Keyword"
    assert kinds["/// Doc."] == "Token.Literal.String.Doc"


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A site of two pages, one of which has keywords."""
    pytest.importorskip("sphinx", reason="needs Sphinx: make site installs it, or pip install 'cspdiag[site]'")
    pytest.importorskip("furo", reason="needs furo: make site installs it, or pip install 'cspdiag[site]'")
    from sphinx.cmd.build import build_main

    folder = tmp_path_factory.mktemp("site")
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(KEYWORDS, "semantics", "gain margin, rendezvous")
        site = Site(folder / "sources", folder / "work")
        page = site.page(Entry("docs/semantics.md", "semantics", "", ""))
    site.save("semantics.md", re.sub(r"\]\((?!#)[^)]*\)", "](#time)", page))
    site.save("index.md", "# A margin of gain\n\n```{toctree}\nsemantics\n```\n\n```csp\nprocess A {}\n```\n")
    options = ["-W", "-q", "-b", "html", "-c", str(CONFIGURATION), "-d", str(folder / "trees")]
    assert build_main([*options, str(folder / "sources"), str(folder / "site")]) == 0
    return folder / "site"


def test_pages_are_built_without_warnings_and_without_dead_links(built: Path) -> None:
    found = [line for line in complaints(built) if "playground" not in line and "#time" not in line]
    assert found == []
    assert '<span class="k">process</span>' in (built / "index.html").read_text(encoding="utf-8")


def test_keywords_lead_to_whole_pages(built: Path) -> None:
    index = (built / "searchindex.js").read_text(encoding="utf-8")
    (searched,) = re.findall(r'"?indexentries"?:\{([^}]*)\}', index)
    assert re.findall(r'"?([\w ]+)"?:\[\[\d+,"([^"]*)"', searched) == [("gain margin", ""), ("rendezvous", "")]
    assert "index-0" not in (built / "semantics.html").read_text(encoding="utf-8")


@pytest.mark.skipif(CHROMIUM is None or shutil.which("node") is None, reason="needs chromium and node")
@has_packages
def test_pages_are_found_by_keywords_and_ask_for_nothing_from_elsewhere(built: Path) -> None:
    addresses = [f"{built.as_uri()}/search.html?q={query}" for query in ("rendezvous", "my+gain+margin%3F", "process")]
    searches = [*visited("#search-results", *addresses), *visited("article", f"{built.as_uri()}/semantics.html")]
    assert [each["errors"] for each in searches] == [[], [], [], []]
    assert [each["links"][0] for each in searches[:3]] == ["semantics.html", "semantics.html", "index.html"]
    asked = [address for each in searches for address in each["asked"]]
    assert f"{built.as_uri()}/_static/search.js" in [address.partition("?")[0] for address in asked]
    assert [address for address in asked if not address.startswith((built.as_uri(), "data:"))] == []


def visited(element: str, *addresses: str) -> list[dict[str, list[str]]]:
    """What pages ask for, the links in an element of them, and the errors of their scripts."""
    command = ["node", "test/e2e/visit.mjs", element, *addresses]
    environment = {**os.environ, "CHROMIUM": str(CHROMIUM)}
    done = subprocess.run(command, cwd=FOLDER, capture_output=True, text=True, env=environment)
    assert done.returncode == 0, done.stderr
    return [json.loads(line) for line in done.stdout.splitlines()]
