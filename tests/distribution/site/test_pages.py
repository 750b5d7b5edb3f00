"""Pages on their way from the repository to the site."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import cspdiag
from distribution.site.contents import KEYWORDS, PICTURES, SECTIONS, Entry
from distribution.site.front import plot, program
from distribution.site.links import complaints
from distribution.site.markdown import Page, converted
from distribution.site.pictures import dark, light
from distribution.site.playground import program_in
from distribution.site.shell import CommandError, Shell, without_times
from distribution.site.stage import Site

ROOT = Path(__file__).parents[3]
ENTRIES = [entry for section in SECTIONS for group in section.groups for entry in group.entries]
DIAGRAM = (ROOT / "docs/pictures/dining.svg").read_text(encoding="utf-8")
PLOT = (ROOT / "docs/images/jiwy.svg").read_text(encoding="utf-8")


@pytest.fixture
def site(tmp_path: Path) -> Site:
    return Site(tmp_path / "sources", tmp_path / "work")


def converted_page(site: Site, source: str, text: str, place: str = "guides/here") -> str:
    page = Page(ROOT / source, place)
    return converted(page, text, site.resolve, site.show)


def test_names_and_units_of_the_curves_are_not_covered_while_they_are_drawn() -> None:
    drawn = plot(cspdiag.parse(program(), "joint.csp").run())
    cover = drawn.index('class="cover"')
    assert drawn.index("angle <tspan>rad</tspan>") > cover
    assert drawn.index("voltage <tspan>V</tspan>") > cover


def test_every_page_is_on_the_site_once() -> None:
    pages = [*ROOT.glob("docs/*.md"), *ROOT.glob("docs/lectures/*.md"), *ROOT.glob("models/*/README.md")]
    expected = {page.relative_to(ROOT).as_posix() for page in pages} | {"docs/design/README.md"}
    # Each diagnostic has a page of its own there.
    expected.remove("docs/diagnostics.md")
    assert sorted(entry.source for entry in ENTRIES if entry.source) == sorted(expected)
    assert len({entry.place for entry in ENTRIES}) == len(ENTRIES)


@pytest.mark.parametrize(
    ("link", "leads_to"),
    [
        ("language.md#time", "../reference/language.md#time"),
        ("../models/dining/README.md", "../gallery/dining.md"),
        ("../models/jiwy/stolen_button.csp", "../gallery/jiwy.md#stolen_buttoncsp"),
        ("diagnostics.md#e0523-event-read-by-several-in-parallel", "../reference/diagnostics/E0523.md"),
        ("diagnostics.md", "../reference/diagnostics/index.md"),
        ("../README.md", "../index.md"),
        ("../models", "../gallery/index.md"),
        ("../Makefile", "https://github.com/cspdiag/cspdiag/blob/main/Makefile"),
        ("https://example.org/x", "https://example.org/x"),
        ("#here", "#here"),
        ("gone.md", "gone.md"),
    ],
)
def test_links_lead_to_the_same_as_in_the_repository(site: Site, link: str, leads_to: str) -> None:
    assert converted_page(site, "docs/timing.md", f"See [it](x)\n[it]({link}).\n") == (
        f"See [it](x)\n[it]({leads_to}).\n"
    )


def test_links_name_pages_and_not_files(site: Site) -> None:
    text = site.page(Entry("docs/notation.md", "reference/notation", "", ""))
    assert "[Drawing](../guides/drawing.md)" in text
    assert ".md](" not in text


def test_keywords_of_the_search_belong_to_pages_that_exist() -> None:
    assert sorted(KEYWORDS) == sorted({entry.place for entry in ENTRIES} & set(KEYWORDS))
    for line in KEYWORDS.values():
        words = line.lower().split(", ")
        assert len(set(words)) == len(words), f"each is there once: {line}"


def test_every_page_of_the_gallery_has_a_picture() -> None:
    pages = {Path(entry.place).name: entry for entry in ENTRIES if entry.place.startswith("gallery/")}
    assert sorted(pages) == sorted(PICTURES)
    for name, picture in PICTURES.items():
        made = f" --plot {picture}\n" in (ROOT / pages[name].source).read_text(encoding="utf-8")
        assert made or (ROOT / "docs" / picture).exists(), picture


def test_a_program_opens_in_the_playground_and_a_fragment_does_not(site: Site) -> None:
    program = "process A {\n  composition { skip }\n}\n"
    made = converted_page(site, "docs/c.md", f"```csp\n{program}```\n\n```csp-fragment\n{program}```\n")
    (link,) = re.findall(r'href="\.\./playground/(#[^"]*)"', made)
    assert program_in(link) == ({"program.csp": program}, "program.csp")


def test_a_program_of_the_repository_is_shown(site: Site) -> None:
    made = converted_page(site, "docs/c.md", "\n<!-- show models/jiwy/stolen_button.csp Panel -->\n")
    assert "```csp\n/// Passes the press of the stop button on" in made
    assert made.count("process ") == 1
    (link,) = re.findall(r'href="\.\./playground/(#[^"]*)"', made)
    assert sorted(program_in(link)[0]) == ["jiwy.csp", "laws.csp", "plant.csp", "stolen_button.csp"]


def test_commands_are_run_and_their_pictures_shown(tmp_path: Path, site: Site) -> None:
    page = Page(ROOT / "docs/lectures/button.md", "gallery/button", Shell(tmp_path / "shell"))
    text = (
        "<!-- a.csp -->\n```csp\nprocess A {\n  composition { skip }\n}\n```\n\n"
        "<!-- run -->\n```sh\n# a comment\ncat a.csp\necho '<svg/>' > b.svg; exit 1\n```\n\n![A picture](b.svg)\n"
    )
    made = converted(page, text, site.resolve, site.show)
    assert "```text\nprocess A {\n  composition { skip }\n}\n```" in made
    assert re.search(r"!\[A picture\]\(\.\./pictures/b-\w+\.svg\)", made)
    with pytest.raises(CommandError, match=r"`cspdiag check a\.csp --wrong` ended with exit code 2"):
        converted(page, "<!-- run -->\n```sh\ncspdiag check a.csp --wrong\n```\n", site.resolve, site.show)


def test_pages_do_not_say_how_long_the_machine_that_made_them_took() -> None:
    printed = (
        "REFUTED  A refines B  (breadth-first, 1615 states, 1.19 s)\n"
        "REFUTED  Table deadlock free  (sat, 11.45 s)\n2 properties: 1 proved, 1 refuted in 11.46 s\n"
        "Table: ended by itself at 210 ms\n  simulated 210 ms in 0.00869 s, 24.2 times real time\n"
        "  fork[0] until 190 ms\n"
    )
    assert without_times(printed) == (
        "REFUTED  A refines B  (breadth-first, 1615 states)\n"
        "REFUTED  Table deadlock free  (sat)\n2 properties: 1 proved, 1 refuted\n"
        "Table: ended by itself at 210 ms\n  simulated 210 ms\n  fork[0] until 190 ms\n"
    )


def test_diagrams_and_plots_are_dark_on_dark_pages() -> None:
    assert "prefers-color-scheme" in DIAGRAM
    assert "#0f1419" in DIAGRAM
    for made, paper in ((light(DIAGRAM), "#ffffff"), (dark(DIAGRAM), "#0f1419")):
        assert made is not None
        assert "prefers-color-scheme" not in made
        assert f"--paper: {paper};" in made
    dark_plot = dark(PLOT)
    assert dark_plot is not None
    assert re.findall(r"#(?:ffffff|000000|1f4e79)", PLOT)
    assert re.findall(r"#(?:ffffff|000000|1f4e79)", dark_plot) == []
    assert dark("<svg/>") is None


def test_dead_links_and_what_is_loaded_from_elsewhere_are_found(tmp_path: Path) -> None:
    (tmp_path / "b.html").write_text("<h1 id=there>b</h1>")
    (tmp_path / "a.html").write_text(
        "<link rel=stylesheet href=https://cdn.example.org/x.css><script src=//cdn.example.org/x.js></script>"
        "<a href=b.html#there>1</a><a href=b.html#gone>2</a><a href=gone.html>3</a><a href=https://example.org>4</a>"
        "<a href='https:// example.org'>5</a><a href=../outside.html>6</a>"
    )
    (tmp_path / "c.css").write_text("@import 'https://cdn.example.org/y.css'; a { background: url(d.png) }")
    assert sorted(complaints(tmp_path)) == [
        "a.html: dead link ../outside.html",
        "a.html: dead link gone.html",
        "a.html: it loads //cdn.example.org/x.js",
        "a.html: it loads https://cdn.example.org/x.css",
        "a.html: there is no b.html#gone",
        "a.html: this is not an address: https:// example.org",
        "c.css: it loads https://cdn.example.org/y.css",
    ]
