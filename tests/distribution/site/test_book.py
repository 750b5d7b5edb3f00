"""The document to print, made of pages of the site."""

from __future__ import annotations

from pathlib import Path

import pytest

from distribution.site.book import NAME, browser, document, pages_of_links, write_book

PAGE = """<html><body><nav>around</nav><article role="main" id="furo-main-content">
<section id="{name}"><h1>The {name}<a class="headerlink" href="#{name}">¶</a></h1>
<section id="time"><h2>Time of {name}<a class="headerlink" href="#time">¶</a></h2>
<p><a href="#time">here</a> <a href="language.html#time">there</a> <a href="../guides/c.html">elsewhere</a>
<img class="only-light" src="a.svg"><img class="only-dark" src="b.svg"></p><p class="play">play</p>
</section></section></article></body></html>"""


@pytest.fixture
def site(tmp_path: Path) -> Path:
    (tmp_path / "reference").mkdir()
    for name in ("language", "notation", "semantics"):
        (tmp_path / "reference" / f"{name}.html").write_text(PAGE.format(name=name), encoding="utf-8")
    return tmp_path


def test_its_links_stay_in_it(site: Path) -> None:
    made = document(site)
    assert made.count('id="notation-time"') == 1
    assert 'href="#notation-time">here' in made
    assert made.count('href="#language-time">there') == 3
    assert "elsewhere" in made
    assert "guides" not in made
    assert '<a class="level2" href="#semantics-time"><span>Time of semantics</span><span></span></a>' in made
    for unwanted in ("around", "¶", "b.svg", ">play<"):
        assert unwanted not in made


def test_a_browser_prints_it(site: Path) -> None:
    pytest.importorskip("pypdf", reason="needs pypdf: make site installs it, or pip install 'cspdiag[site]'")
    program = browser()
    if program is None:
        pytest.skip("no browser: install chromium")
    write_book(site, program)
    pages = pages_of_links(site / NAME)
    assert [pages[name] for name in ("language-time", "notation-time", "semantics-time")] == [2, 3, 4]
    assert "<span>Time of notation</span><span>3</span>" in document(site, pages)
    assert not (site / "reference" / "printed.html").exists()
