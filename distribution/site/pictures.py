"""Pictures in light and dark: those of ``cspdiag draw`` know both, figures of matplotlib get other colours."""

from __future__ import annotations

import re
from colorsys import hls_to_rgb, rgb_to_hls

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
        recoloured = _COLOUR.sub(lambda found: _in_the_dark(found[0]), svg)
        return recoloured.replace('<g id="figure_1">', f'<g id="figure_1" fill="{_in_the_dark("#000000")}">', 1)
    return None


def _in_the_dark(colour: str) -> str:
    """The colour of the same hue that is as bright as this one is dark; white becomes the paper of a dark page."""
    hue, lightness, saturation = rgb_to_hls(*(int(colour[at : at + 2], 16) / 255 for at in (1, 3, 5)))
    parts = hls_to_rgb(hue, 0.92 - 0.845 * lightness, saturation)
    return "#" + "".join(f"{round(255 * part):02x}" for part in parts)


def light(svg: str) -> str:
    """The same picture for a light page, whatever the viewer prefers."""
    schemes = _AUTO.search(svg)
    return svg if schemes is None else _with_colours(svg, schemes["light"])


def _with_colours(svg: str, definitions: str) -> str:
    return _AUTO.sub(f"\n    .cspdiag.auto {{{definitions}}}", svg)


def without_scheme(svg: str) -> str:
    """The same picture without colours of its own, for a page that defines them."""
    return _AUTO.sub("", svg)
