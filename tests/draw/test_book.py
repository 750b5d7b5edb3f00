"""The book of a program: one page that contains everything, and whose links lead somewhere."""

from __future__ import annotations

import re
from html.parser import HTMLParser
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cspdiag.base import SourceFile
from cspdiag.base.sources import read_source
from cspdiag.cli.main import main
from cspdiag.draw.book.highlight import highlighted
from cspdiag.draw.book.page import book
from cspdiag.draw.layout.elk import engine_available
from cspdiag.draw.pictures import Pictures
from cspdiag.pipeline import check
from tests.draw.geometry.browser import BROWSER, answer

ROOT = Path(__file__).parents[2]

needs_engine = pytest.mark.skipif(not engine_available(), reason="the layout engine was not fetched (make setup)")

PROGRAM = """/// At most <b>this</b> & no more.
const limit = 3

/// Counts "ticks".
process Counter(start: int = 0) {
  /// The ticks.
  in tick : int
  communication {
    var n : int = start
  }
  composition {
    tick ? n
  }
}

process Ticker {
  out tick : int
  composition {
    tick ! limit
  }
}

process Unused {
  composition {
    skip
  }
}

process Clock {
  communication {
    ticker : Ticker
    counter : Counter(start = limit)
    ticker.tick -> counter.tick
  }
  composition {
    ticker || counter
  }
}
"""


class Page(HTMLParser):
    """The parts of a page that the tests need."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.ids: list[str] = []
        self.links: list[str] = []
        self.loaded: list[str] = []
        self.words: list[str] = []
        self.tags: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        for name, value in attrs:
            if name == "id":
                self.ids.append(value or "")
            elif name == "href":
                (self.loaded if tag == "link" else self.links).append(value or "")
            elif name == "src":
                self.loaded.append(value or "")

    def handle_data(self, data: str) -> None:
        self.words.append(data)


def page_of(text: str) -> str:
    checked = check(SourceFile(name="clock.csp", text=text), read_source)
    assert checked.readable is not None
    assert not checked.report.has_errors
    return book(Pictures(checked.readable))


@needs_engine
def test_every_definition_has_a_chapter_with_its_diagrams_text_and_ports() -> None:
    text = page_of(PROGRAM)
    page = Page(text)
    chapters = [name for name in page.ids if name.startswith("of-")]
    assert chapters == ["of-Clock", "of-Ticker", "of-Counter", "of-Unused"]
    assert {"Clock-Communication", "Clock-Composition", "Unused-Composition"} <= set(page.ids)
    shown = "".join(page.words)
    assert 'Counts "ticks".' in shown
    assert "The ticks." in shown
    assert "a rendezvous" in shown
    for line in PROGRAM.splitlines():
        assert line in shown
    assert "part of Clock" in re.sub(r"\s+", " ", shown)


@needs_engine
def test_links_lead_into_the_page_and_nothing_is_loaded() -> None:
    page = Page(page_of(PROGRAM))
    assert len(page.ids) == len(set(page.ids))
    assert page.loaded == []
    assert page.links.count("#of-Counter") >= 4
    assert {link.removeprefix("#") for link in page.links} <= set(page.ids)


@needs_engine
def test_text_is_not_taken_for_markup() -> None:
    assert "b" not in Page(page_of(PROGRAM)).tags


@needs_engine
@pytest.mark.skipif(BROWSER is None, reason="Chromium is not installed")
def test_the_page_fits_a_phone_and_a_wide_screen(tmp_path: Path) -> None:
    """Wide drawings scroll in their own frame; the page does not."""
    checked = check(read_source(str(ROOT / "models/jiwy/jiwy.csp")), read_source)
    assert checked.readable is not None
    page = book(Pictures(checked.readable)).replace("&", "&amp;").replace('"', "&quot;")
    frames = "".join(f'<iframe width={width} height=900 srcdoc="{page}"></iframe>' for width in (360, 800, 1600))
    script = """<script>onload = () => {
      const widths = [...document.querySelectorAll("iframe")].map((frame) => [frame.contentDocument.documentElement.scrollWidth, frame.clientWidth]);
      const answer = document.createElement("pre");
      answer.id = "answer";
      answer.textContent = JSON.stringify(widths);
      document.body.append(answer);
    };</script>"""
    widths = answer(tmp_path, f"<!doctype html><meta charset=utf-8>{frames}{script}")
    assert [shown for _, shown in widths] == [360, 800, 1600]
    assert all(needed <= shown for needed, shown in widths)


@needs_engine
def test_errors_are_marked_and_reported_once_if_requested(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    program, page = tmp_path / "clock.csp", tmp_path / "clock.html"
    program.write_text(PROGRAM.replace("-> counter.tick", "-> counter.tock"))
    assert main(["draw", str(program), "--book", str(page)]) == 1
    assert not page.exists()
    assert main(["draw", str(program), "--book", str(page), "--check"]) == 1
    assert "error[" in capsys.readouterr().err
    reported = re.findall(r"<text[^>]*>(?:<tspan[^>]*>)?E\d{4}", page.read_text())
    assert len(reported) == 1


@given(st.text(alphabet="pin process<>/\"'*\n\r\t 0123._@{}->\N{SNOWMAN}\f", max_size=80))
@settings(max_examples=200)
def test_the_pieces_of_a_text_add_up_to_it(text: str) -> None:
    lines = highlighted(text, {"process": "#x"})
    assert "\n".join("".join(piece.text for piece in line) for line in lines) == text


def test_words_have_the_looks_of_the_language() -> None:
    (line,) = highlighted("  in a : double<rad/s> @ 10 ms // every", {"a": "#of-a"})
    by_text = {piece.text: (piece.kind, piece.link) for piece in line if piece.text.strip()}
    assert by_text["in"] == ("keyword", "")
    assert by_text["a"] == ("", "#of-a")
    assert by_text["double"] == by_text["<rad/s>"] == ("type", "")
    assert by_text["10 ms"] == ("number", "")
    assert by_text["// every"] == ("comment", "")


@needs_engine
def test_the_verb_writes_the_page(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    program, page = tmp_path / "a clock.csp", tmp_path / "the book.html"
    program.write_text(PROGRAM)
    assert main(["draw", str(program), "--book", str(page)]) == 0
    assert capsys.readouterr().err == f"wrote {page}\n"
    assert "<title>a clock</title>" in page.read_text()


def test_the_verb_refuses_a_page_in_no_folder_or_in_another_format(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    program = tmp_path / "clock.csp"
    program.write_text(PROGRAM)
    assert main(["draw", str(program), "--book", str(tmp_path / "no" / "book.html")]) == 2
    assert "there is no folder" in capsys.readouterr().err
    assert main(["draw", str(program), "--book", "book.html", "-o", "book.pdf"]) == 2
    assert "-o" in capsys.readouterr().err
