"""The language and its notation as one document to print: pages of the site, without what is for screens."""

from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Mapping
from pathlib import Path

import cspdiag

NAME = "cspdiag-language.pdf"
_BROWSERS = ("chromium", "chromium-browser", "google-chrome")
_PAGES = ("language", "notation", "semantics")
_STYLE = Path(__file__).parent / "sphinx" / "print.css"


def browser() -> str | None:
    """The browser that prints; None if there is none."""
    return next(filter(None, map(shutil.which, _BROWSERS)), None)


def write_book(site: Path, program: str) -> None:
    """Print the document into the top folder of a built site. Raises CalledProcessError if the browser fails.

    Browsers do not know on which page an element comes to lie while they print the contents. So it is printed twice:
    the first document says where its headings are, and the numbers take the room that is left for them.
    """
    _print(site, program, {})
    _print(site, program, pages_of_links(site / NAME))


def _print(site: Path, program: str, pages: Mapping[str, int]) -> None:
    printed = site / "reference" / "printed.html"
    printed.write_text(document(site, pages), encoding="utf-8")
    options = [
        "--headless",
        "--no-sandbox",
        "--disable-gpu",
        "--no-pdf-header-footer",
        "--generate-pdf-document-outline",
    ]
    try:
        subprocess.run(
            [program, *options, f"--print-to-pdf={site / NAME}", printed.as_uri()],
            check=True,
            capture_output=True,
            timeout=300,
        )
    finally:
        printed.unlink()


def _article(path: Path) -> str:
    """The text of a page, whose identifiers begin with its name."""
    html = path.read_text(encoding="utf-8")
    article = html.partition('<article role="main" id="furo-main-content">')[2].partition("</article>")[0]
    article = re.sub(r'<a class="headerlink".*?</a>', "", article, flags=re.DOTALL)
    article = re.sub(r'<p class="play">.*?</p>', "", article, flags=re.DOTALL)
    article = re.sub(r'<img[^>]*class="[^"]*only-dark[^>]*>', "", article)
    article = re.sub(r'\bid="([^"]*)"', rf'id="{path.stem}-\1"', article)
    article = re.sub(r'href="#([^"]*)"', rf'href="#{path.stem}-\1"', article)
    article = re.sub(rf'href="({"|".join(_PAGES)})\.html#([^"]*)"', r'href="#\1-\2"', article)
    article = re.sub(rf'href="({"|".join(_PAGES)})\.html"', r'href="#\1"', article)
    # What the document does not contain is named, and not linked.
    article = re.sub(r'href="(?!#|https?:)[^"]*"', "", article)
    return f'<article id="{path.stem}">{article}</article>'


def pages_of_links(pdf: Path) -> dict[str, int]:
    """The page, from 1, of each identifier that a link of a document leads to, which a browser has printed."""
    from pypdf import PdfReader

    reader = PdfReader(pdf)
    found = {name: reader.get_destination_page_number(place) for name, place in reader.named_destinations.items()}
    return {name.removeprefix("/"): page + 1 for name, page in found.items() if page is not None}


def document(site: Path, pages: Mapping[str, int] | None = None) -> str:
    """The document as HTML, for the folder ``reference`` of the site; the contents have the numbers of these pages."""
    articles = [_article(site / "reference" / f"{name}.html") for name in _PAGES]
    return (
        f'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>The language of cspdiag</title>'
        f'<link rel="stylesheet" href="../_static/pygments.css">'
        f"<style>{_STYLE.read_text(encoding='utf-8')}</style></head><body data-theme='light'>"
        f"<header><p>cspdiag {cspdiag.__version__}</p><p class='title'>The language, its notation and its semantics</p>"
        f"<p>{_contents(articles, pages or {})}</p></header>{''.join(articles)}</body></html>"
    )


def _contents(articles: list[str], pages: Mapping[str, int]) -> str:
    """The headings of the first two levels, with links and pages."""
    found = [
        (level, identifier, re.sub(r"<[^>]*>", "", title))
        for article in articles
        for identifier, level, title in re.findall(r'<section id="([^"]*)">\s*<h([12])>(.*?)</h', article, re.DOTALL)
    ]
    return "".join(
        f'<a class="level{level}" href="#{identifier}"><span>{title}</span><span>{pages.get(identifier, "")}</span></a>'
        for level, identifier, title in found
    )
