"""Scenes as SVG, PNG and PDF."""

from __future__ import annotations

import re
from xml.etree import ElementTree

import pytest

from cspdiag.draw import missing
from cspdiag.draw.output import png
from cspdiag.draw.output.pdf import render_pdf
from cspdiag.draw.output.png import render_png
from cspdiag.draw.output.svg import embedded_svg, render_svg
from cspdiag.draw.scene import palette
from cspdiag.draw.scene.geometry import Point, Rectangle
from cspdiag.draw.scene.palette import DARK, LIGHT, Scheme
from cspdiag.draw.scene.scene_geometry import beside, bounds, fitted, stacked
from cspdiag.draw.scene.shapes import Box, Dash, Ellipse, Face, Group, Head, Ink, Line, Scene, Text, TextRun
from cspdiag.draw.scene.text_metrics import text_width

SVG = "{http://www.w3.org/2000/svg}"


def words(text: str, face: Face = Face.SANS) -> Text:
    return Text(Point(10, 20), (TextRun(text, face),))


def scene(*items: Group | Text | Box | Line | Ellipse, name: str = "") -> Scene:
    return fitted(items, title="A <drawing>", name=name)


def parsed(drawing: Scene, scheme: Scheme = Scheme.AUTO) -> ElementTree.Element:
    return ElementTree.fromstring(render_svg(drawing, scheme))


def test_words_stay_words_whatever_they_contain() -> None:
    texts = [
        "a < b && c > \"d\" 'e'",
        "]]> --> <!--",
        "bell \a and null \0",
        "\N{GREEK SMALL LETTER MU} \N{CJK UNIFIED IDEOGRAPH-4E2D}",
    ]
    root = parsed(scene(*(words(text) for text in texts)))
    shown = ["".join(each.itertext()) for each in root.iter(f"{SVG}text")]
    assert shown[:2] == texts[:2]
    assert shown[2] == "bell \N{REPLACEMENT CHARACTER} and null \N{REPLACEMENT CHARACTER}"
    assert shown[3] == texts[3]


def test_identifiers_are_valid_different_and_begin_with_the_name() -> None:
    same = tuple(Group("process", (words("x"),), id=key) for key in ("a.b", "a b", "a/b", "9", "\N{SNOWMAN}"))
    root = parsed(scene(*same, name="Jiwy: top"))
    found = [each.attrib["id"] for each in root.iter() if "id" in each.attrib]
    assert found == ["Jiwy-top", "Jiwy-top-a-b", "Jiwy-top-a-b-2", "Jiwy-top-a-b-3", "Jiwy-top-9", "Jiwy-top-2"]


def test_groups_carry_their_kind_tooltip_and_link() -> None:
    group = Group("process submodel", (words("servo"),), id="servo", title='follows "<', link="#of-Servo?a=1&b=2")
    root = parsed(scene(group))
    (found,) = root.findall(f"{SVG}g")
    assert found.attrib["class"] == "process submodel"
    assert found.findtext(f"{SVG}title") == 'follows "<'
    (link,) = found.findall(f"{SVG}a")
    assert link.attrib["href"] == "#of-Servo?a=1&b=2"
    assert link.findtext(f"{SVG}text") == "servo"


def test_the_same_scene_gives_the_same_bytes() -> None:
    drawing = scene(words("x"), Line((Point(0, 0), Point(0, 40), Point(90, 40)), corner=6, end=Head.ARROW))
    assert render_svg(drawing) == render_svg(drawing)
    assert render_png(drawing) == render_png(drawing)
    assert render_pdf([drawing]) == render_pdf([drawing])


def test_automatic_colours_follow_the_viewer_and_forced_ones_do_not() -> None:
    drawing = scene(Box(Rectangle(0, 0, 50, 50)))
    automatic, dark, light = (render_svg(drawing, scheme) for scheme in (Scheme.AUTO, Scheme.DARK, Scheme.LIGHT))
    assert "prefers-color-scheme: dark" in automatic
    assert LIGHT[Ink.BORDER] in automatic
    assert DARK[Ink.BORDER] in automatic
    assert "prefers-color-scheme" not in dark + light
    assert LIGHT[Ink.BORDER] not in dark
    assert DARK[Ink.BORDER] not in light


def test_an_embedded_drawing_leaves_the_colours_to_its_page() -> None:
    drawing = embedded_svg(scene(Box(Rectangle(0, 0, 50, 50))))
    assert "<style>" not in drawing
    assert 'class="fill-process stroke-border"' in drawing


@pytest.mark.parametrize("table", [LIGHT, DARK])
def test_words_and_lines_contrast_with_their_background(table: dict[Ink, str]) -> None:
    """WCAG 2.2, 1.4.3 and 1.4.11: 4.5 to 1 for words, 3 to 1 for lines."""
    papers = [
        ink
        for ink in Ink
        if ink in {Ink.PAPER, Ink.PROCESS, Ink.SUBMODEL, Ink.VARIABLE, Ink.FRAME} or ink.value.endswith("-fill")
    ]
    assert len(papers) == 11
    for paper in papers:
        for ink in (Ink.TEXT, Ink.FAINT):
            assert contrast(table[ink], table[paper]) >= 4.5, (ink, paper)
        for ink in (Ink.LINE, Ink.BORDER, Ink.ACCENT, Ink.ERROR, Ink.WARNING, Ink.ADDED, Ink.REMOVED, Ink.CHANGED):
            assert contrast(table[ink], table[paper]) >= 3, (ink, paper)


def contrast(first: str, second: str) -> float:
    light, dark = sorted((luminance(first), luminance(second)), reverse=True)
    return (light + 0.05) / (dark + 0.05)


def luminance(colour: str) -> float:
    parts = [int(colour[at : at + 2], 16) / 255 for at in (1, 3, 5)]
    linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def test_dashes_are_distinguished_without_colour() -> None:
    assert len(set(palette.DASHES.values())) == len(Dash)


def test_an_arrow_points_exactly_at_the_end_of_its_line() -> None:
    drawn = render_svg(Scene(100, 100, (Line((Point(10, 50), Point(80, 50)), end=Head.ARROW),)))
    assert re.search(r'd="M80 50L71 [\d.]+L71 [\d.]+Z"', drawn)


def test_texts_are_measured_as_arial_is() -> None:
    """Advance widths of Arial, in thousandths of its size: from its tables."""
    assert text_width("W", 1000) == pytest.approx(944, abs=1)
    assert text_width("i", 1000) == pytest.approx(222, abs=1)
    assert text_width("0123456789", 1000) == pytest.approx(5560, abs=2)
    assert text_width("W", 1000, Face.MONO) == text_width("i", 1000, Face.MONO) == pytest.approx(600, abs=1)
    assert text_width("a\N{COMBINING ACUTE ACCENT}", 10) == text_width("a", 10)


def test_scenes_are_joined_without_overlap() -> None:
    first, second = (fitted((Box(Rectangle(-20, 7, width, 30)),)) for width in (40, 90))
    for joined in (stacked([first, second], gap=8), beside([first, second], gap=8)):
        one, other = (bounds(item) for item in joined.items)
        assert not one.overlaps(other)
        assert Rectangle(0, 0, joined.width, joined.height).contains(other)


def test_a_png_has_the_requested_size_and_the_colours_of_the_scheme() -> None:
    drawing = Scene(60, 40, (Box(Rectangle(10, 10, 20, 20)),))
    for scheme, paper in ((Scheme.LIGHT, LIGHT), (Scheme.DARK, DARK), (Scheme.AUTO, LIGHT)):
        picture = render_png(drawing, scheme, scale=3)
        assert picture[:8] == b"\x89PNG\r\n\x1a\n"
        assert [int.from_bytes(picture[at : at + 4], "big") for at in (16, 20)] == [180, 120]
        assert pixel(picture, 2, 2) == paper[Ink.PAPER]
        assert pixel(picture, 60, 60) == paper[Ink.PROCESS]


def pixel(picture: bytes, x: int, y: int) -> str:
    from io import BytesIO

    from PIL import Image

    red, green, blue = Image.open(BytesIO(picture)).convert("RGB").getpixel((x, y))  # type: ignore[misc]
    return f"#{red:02x}{green:02x}{blue:02x}"


def test_a_huge_png_is_made_smaller() -> None:
    assert png._bounded(Scene(100_000, 100_000, ()), 2) == pytest.approx(0.1)


def test_a_pdf_has_a_page_for_each_drawing_and_its_words_as_words() -> None:
    pages = [scene(words("first")), scene(words("second", Face.BOLD), Ellipse(Rectangle(0, 0, 9, 9)))]
    made = render_pdf(pages)
    assert made.startswith(b"%PDF-")
    assert made.count(b"/Type /Page\n") == 2
    # The typefaces that are shipped include the table from glyphs to letters; the viewer's own needs none.
    assert b"/ToUnicode" in made or b"/Helvetica" in made


@pytest.mark.parametrize(("module", "package"), [("resvg_py", "resvg-py"), ("fpdf", "fpdf2")])
def test_missing_packages_are_named(module: str, package: str, monkeypatch: pytest.MonkeyPatch) -> None:
    import sys

    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(missing.MissingToolError, match=rf"needs {package}: pip install 'cspdiag\[draw\]'"):
        render_png(scene(words("x"))) if module == "resvg_py" else render_pdf([scene(words("x"))])
