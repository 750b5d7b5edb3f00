"""The front page: a program, its diagrams, its proof and its run in the first screen, all four made by the code."""

from __future__ import annotations

import re
from html import escape
from pathlib import Path
from typing import Literal

from pygments import highlight
from pygments.formatters.html import HtmlFormatter

import cspdiag
from cspdiag.draw.output.svg import custom_properties
from cspdiag.draw.scene.palette import Scheme
from cspdiag.simulate.result import Run
from distribution.site.highlighting import CspLexer
from distribution.site.markdown import Page, parts
from distribution.site.pictures import without_scheme
from distribution.site.playground import fragment
from distribution.site.shell import Shell

ROOT = Path(__file__).parents[2]
LANGUAGE = ROOT / "docs" / "language.md"
TEXT = Path(__file__).parent / "sphinx" / "front.md"
_HEADINGS: dict[Literal["communication", "composition"], int] = {"communication": 62, "composition": 46}
"""The height of the heading of a diagram, which the front page does without."""
WIDTH, HEIGHT, LEFT, TOP, GAP = 560, 250, 46, 12, 26
"""The size of the plot in pixels, the room for labels, and the distance of its two panels."""


def program() -> str:
    """The whole program with which the language reference begins."""
    found = (part for part in parts(LANGUAGE.read_text(encoding="utf-8")) if not isinstance(part, str))
    return next(block.text for block in found if block.language == "csp")


def page(page: Page, shell: Shell) -> str:
    """The page."""
    text = program()
    shell.write("joint.csp", text)
    played = f"{page.up}playground/{fragment({'joint.csp': text}, 'joint.csp')}"
    link = f'<a class="button first" href="{escape(played)}">Open it in the playground</a>'
    run = cspdiag.parse(text, "joint.csp").run()
    panels = {
        "PROGRAM": _code(_definition(text)),
        "DIAGRAMS": "".join(_diagram(text, which) for which in _HEADINGS),
        "PROOF": f"<pre>{escape(_proof(shell))}</pre>",
        "RUN": plot(run),
        "PLAY": link if page.playground == "linked" else "",
        "SCHEMES": schemes(),
        "COMPARISON": _of_readme("What you get, and what you do not"),
    }
    made = TEXT.read_text(encoding="utf-8")
    for name, content in panels.items():
        made = made.replace(f"@{name}@", content)
    return made


def _of_readme(heading: str) -> str:
    """The text of a section of the README."""
    return (
        (ROOT / "README.md").read_text(encoding="utf-8").partition(f"## {heading}\n")[2].partition("\n## ")[0].strip()
    )


def schemes() -> str:
    """The colours of embedded diagrams, which follow the page and not the viewer."""
    light, dark = (custom_properties(scheme) for scheme in (Scheme.LIGHT, Scheme.DARK))
    return (
        f"<style>body .cspdiag.auto {{ {light} }} body[data-theme=dark] .cspdiag.auto {{ {dark} }} "
        f"@media (prefers-color-scheme: dark) {{ body:not([data-theme=light]) .cspdiag.auto {{ {dark} }} }}</style>"
    )


def plot(run: Run) -> str:
    """The angle and the voltage of the run as SVG, which draws itself once, like a recorder."""
    end = run.outcome.time / 1e9
    height = (HEIGHT - 2 * TOP - GAP - 12) / 2
    curves, names = zip(
        _panel(run, "angle", "rad", TOP, height, end, (0.0, 0.5)),
        _panel(run, "voltage", "V", TOP + height + GAP, height, end, (0.0, 2.0)),
        strict=True,
    )
    ticks = "".join(
        f'<text class="tick" text-anchor="{"end" if at == 2 else "middle"}" x="{_x(at, end):.1f}" '
        f'y="{HEIGHT - 4}">{at:g} s</text>'
        for at in (0, 0.5, 1, 1.5, 2)
    )
    pressed = f'<text class="tick" text-anchor="end" x="{WIDTH - 8}" y="{TOP + height - 22:.1f}">button pressed</text>'
    return (
        f'<svg class="recorder" viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="The angle rises to 0.5 rad in '
        f'half a second and stays there; the voltage falls from 2 V to 0 V">{"".join(curves)}{ticks}{pressed}'
        f'<svg x="{LEFT}" y="0" width="{WIDTH - LEFT}" height="{HEIGHT - 18}"><g class="cover">'
        f'<rect width="{WIDTH}" height="{HEIGHT}"/><path d="M0.5 0V{HEIGHT}"/></g></svg>{"".join(names)}</svg>'
    )


def _panel(
    run: Run, name: str, unit: str, top: float, height: float, end: float, ticks: tuple[float, ...]
) -> tuple[str, str]:
    """The curve with its grid, and its name, which stands there from the start."""
    times, values = run.time(name), run[name]
    low, high = float(min(*ticks, *values)), float(max(*ticks, *values))

    def y(value: float) -> float:
        return top + height * (1 - (value - low) / (high - low))

    steps, before = [], None
    for time, value in zip(times, values, strict=True):
        if before is None:
            steps.append(f"M{_x(time, end):.1f} {y(value):.1f}")
        elif abs(value - before) > (high - low) / 400:
            steps.append(f"H{_x(time, end):.1f}V{y(value):.1f}")
        else:
            continue
        before = value
    steps.append(f"H{_x(end, end):.1f}")
    labels = "".join(
        f'<path class="grid" d="M{LEFT} {y(at):.1f}H{WIDTH - 8}"/>'
        f'<text class="tick" text-anchor="end" x="{LEFT - 6}" y="{y(at) + 4:.1f}">{at:g}</text>'
        for at in ticks
    )
    return (
        f'{labels}<path class="curve" d="{"".join(steps)}"/>',
        f'<text class="name" text-anchor="end" x="{WIDTH - 8}" y="{y(ticks[-1]) - 8:.1f}">'
        f"{name} <tspan>{unit}</tspan></text>",
    )


def _x(time: float, end: float) -> float:
    return LEFT + (WIDTH - 8 - LEFT) * time / end


def _definition(text: str) -> str:
    """The process alone, with its comment."""
    found = re.search(r"^///[^\n]*\nprocess .*?^}\n", text, re.MULTILINE | re.DOTALL)
    assert found is not None
    return found[0].split("\n", 1)[1]


def _code(text: str) -> str:
    return highlight(text, CspLexer(), HtmlFormatter())


def _diagram(text: str, which: Literal["communication", "composition"]) -> str:
    drawn = cspdiag.parse(text, "joint.csp").draw("Joint", diagram=which, hide_labels=["types", "legend"])
    svg = without_scheme(drawn.svg())
    size = re.search(r'width="([\d.]+)" height="([\d.]+)" viewBox="[^"]*"', svg)
    assert size is not None
    width, height, cut = float(size[1]), float(size[2]), _HEADINGS[which]
    svg = svg.replace(
        size[0], f'width="{width:g}" height="{height - cut:g}" viewBox="0 {cut} {width:g} {height - cut:g}"'
    )
    # Both diagrams are on one page, so each needs identifiers of its own.
    return re.sub(r'(\bid="|url\(#|href="#)', rf"\1{which}-", svg)


def _proof(shell: Shell) -> str:
    command = "cspdiag verify joint.csp"
    return f"$ {command}\n{shell.run(command)}".rstrip()
