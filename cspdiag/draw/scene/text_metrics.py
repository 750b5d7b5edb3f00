"""How wide texts are in Helvetica, Arial and the fonts made to their measures (Liberation Sans, Arimo), and in
Courier's.

The advances were read from Arimo 400 and 700 (SIL Open Font License), whose measures are those of Arial, for the
characters that programs and units are written with; its italics have the same. Others count as wide as an ideograph or
a capital letter.
"""

# ruff: noqa: RUF001

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from unicodedata import combining, east_asian_width

from cspdiag.draw.scene.shapes import Face, TextRun

UNITS = 2048
"""Units of the advances per em."""

ASCENT = 0.905
"""The height of a line above its baseline, as a fraction of the size; capital letters take 0.716 of the size."""
DESCENT = 0.212
"""The depth of a line below its baseline, as a fraction of the size."""
CAPITAL = 0.716
"""The height of a capital letter or a digit, as a fraction of the size."""

_MONO = 1229
_OTHER = 1366

_REGULAR = {
    384: "′",
    391: "'",
    455: "ijlι‘’",
    532: "|¦",
    561: "∫",
    569: " !,./:;I[\\]ft\xa0ÌÍÎÏìíîï",
    682: "()-`r¡¨\xad²³´·¸¹“”⁰⁴⁵⁶⁷⁸⁹⁻",
    684: "{}",
    717: "•",
    725: "″",
    726: "▪",
    727: '"',
    748: "º",
    758: "ª",
    797: "*",
    809: "τ",
    819: "°",
    903: "ζ",
    913: "ε",
    917: "ξ",
    961: "^",
    987: "ς",
    1012: "∂◊",
    1024: "Jcksvxyzçýÿγκλν↑↓",
    1075: "χ",
    1100: "¶",
    1120: "υ",
    1124: "±÷√≈≠≤≥",
    1128: "Γ",
    1131: "¯",
    1139: "#$0123456789?L_abdeghnopqu¢£¤¥§«»àáâãäåèéêëðñòóôõöùúûüþηθο–†",
    1140: "δ",
    1147: "ϕ",
    1165: "ρ",
    1178: "β",
    1180: "µμ",
    1184: "α",
    1196: "+<=>~¬×−",
    1237: "□○●",
    1251: "FTZ¿ßø",
    1253: "∆",
    1264: "σ",
    1266: "Σ",
    1328: "φ",
    1331: "Ξ",
    1366: "&ABEKPSVXYÀÁÂÃÄÅÈÉÊËÝÞ",
    1368: "ΔΛ",
    1413: "π",
    1460: "ψ∑∞",
    1472: "∩",
    1479: "CDHNRUwÇÐÑÙÚÛÜΠ",
    1509: "©®",
    1531: "ΩΩ",
    1593: "GOQÒÓÔÕÖØΘ",
    1599: "ω",
    1634: "Φ",
    1686: "∏",
    1706: "Mm",
    1708: "¼½¾",
    1711: "Ψ",
    1821: "%æ",
    1933: "W",
    2027: "▲►▼◄",
    2048: "Æ—…←→↔",
    2079: "@",
}

_BOLD = {
    487: "'",
    491: "′",
    561: "∫",
    569: " ,./I\\ijl\xa0ÌÍÎÏìíîïι‘’",
    573: "|¦",
    682: "!()-:;[]`ft¡¨\xad²³´·¸¹⁰⁴⁵⁶⁷⁸⁹⁻",
    717: "•",
    726: "▪",
    748: "º",
    758: "ª",
    797: "*r{}",
    819: "°",
    912: "ξ",
    914: "τ",
    943: "ζ",
    971: '"',
    972: "ε",
    981: "″",
    1012: "∂◊",
    1024: "z“”↑↓",
    1065: "ς",
    1107: "θ",
    1124: "±÷√≈≠≤≥",
    1131: "¯",
    1139: "#$0123456789J_aceksvxy¢£¤¥§«¶»àáâãäåçèéêëýÿγλν–†",
    1142: "κ",
    1179: "χ",
    1192: "υ",
    1196: "+<=>^~¬×−",
    1229: "µΣ",
    1231: "Γ",
    1237: "□○●",
    1242: "δ",
    1250: "β",
    1251: "?FLTZbdghnopqu¿ßðñòóôõöøùúûüþηο",
    1253: "μ∆",
    1259: "α",
    1267: "ρ",
    1318: "Ξ",
    1366: "EPSVXYÈÉÊËÝÞΛ",
    1401: "σ",
    1460: "∑∞",
    1465: "φ",
    1472: "Δ",
    1479: "&ABCDHKNRUÀÁÂÃÄÅÇÐÑÙÚÛÜΠ∩",
    1509: "©®",
    1535: "ϕ",
    1543: "ψ",
    1568: "π",
    1593: "GOQwÒÓÔÕÖØΘ",
    1642: "ΩΩ",
    1657: "Ψ",
    1681: "Φ",
    1686: "∏",
    1706: "M",
    1708: "¼½¾",
    1730: "ω",
    1821: "%mæ",
    1933: "W",
    1997: "@",
    2027: "▲►▼◄",
    2048: "Æ—…←→↔",
}


@cache
def _advances(bold: bool) -> dict[str, int]:
    return {character: advance for advance, group in (_BOLD if bold else _REGULAR).items() for character in group}


def _unknown(character: str) -> int:
    if combining(character):
        return 0
    return UNITS if east_asian_width(character) in "WF" else _OTHER


def text_width(text: str, size: float, face: Face = Face.SANS) -> float:
    """The width in pixels of a text whose em is ``size`` pixels."""
    if face is Face.MONO:
        units = sum(2 * _MONO if east_asian_width(each) in "WF" else 0 if combining(each) else _MONO for each in text)
    else:
        advances = _advances(face is Face.BOLD)
        units = sum(advances[each] if each in advances else _unknown(each) for each in text)
    return units * size / UNITS


def is_measured(text: str) -> bool:
    """Whether all characters are among those whose widths are known."""
    return all(each in _advances(False) for each in text)


def runs_width(runs: Iterable[TextRun], size: float) -> float:
    """The width in pixels of pieces of text that follow each other."""
    return sum(text_width(run.text, size, run.face) for run in runs)


def line_height(size: float) -> float:
    """From the top of a line's tallest character to the bottom of its lowest, in pixels."""
    return (ASCENT + DESCENT) * size
