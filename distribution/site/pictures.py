"""Pictures in light and dark: those of ``cspdiag draw`` know both, figures of matplotlib get other colours."""

from __future__ import annotations

import re

_DARK = {
    "#ffffff": "#131416",
    "#000000": "#e6e8ea",
    "#222222": "#dfe3e7",
    "#666666": "#9aa4af",
    "#bbbbbb": "#5b626b",
    "#dddddd": "#33383e",
    "#1f4e79": "#79aede",
    "#bcd3ea": "#2b4a68",
    "#8bb0d6": "#3f6a92",
    "#dbe9f6": "#1d3043",
    "#c0504d": "#e88a87",
    "#4f8a3c": "#8cc878",
    "#7f5fa0": "#b79ad6",
    "#b07d2b": "#d9ac62",
    "#3a8f99": "#6cc3cd",
}
"""The colours of plots on a dark page; those of lines have the same order of brightness."""
_COLOUR = re.compile(r"#[0-9a-f]{6}\b")
_AUTO = re.compile(
    r"\s*\.cspdiag\.auto \{(?P<light>[^}]*)\}"
    r"\s*@media \(prefers-color-scheme: dark\) \{ \.cspdiag\.auto \{(?P<dark>[^}]*)\} \}"
    r"\s*@media print \{[^}]*\} \}"
)


def dark(svg: str) -> str | None:
    """The same picture for a dark page; None if its colours are not known."""
    schemes = _AUTO.search(svg)
    if schemes is not None:
        return _with_colours(svg, schemes["dark"])
    if "Matplotlib" in svg[:2000]:
        # Text without a colour is black, which the outermost group changes.
        recoloured = _COLOUR.sub(lambda found: _DARK.get(found[0], found[0]), svg)
        return recoloured.replace('<g id="figure_1">', '<g id="figure_1" fill="#e6e8ea">', 1)
    return None


def light(svg: str) -> str:
    """The same picture for a light page, whatever the viewer prefers."""
    schemes = _AUTO.search(svg)
    return svg if schemes is None else _with_colours(svg, schemes["light"])


def _with_colours(svg: str, definitions: str) -> str:
    return _AUTO.sub(f"\n    .cspdiag.auto {{{definitions}}}", svg)


def without_scheme(svg: str) -> str:
    """The same picture without colours of its own, for a page that defines them."""
    return _AUTO.sub("", svg)
