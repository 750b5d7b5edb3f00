"""Checks what has been built: links have targets, and nothing is loaded from elsewhere."""

from __future__ import annotations

import re
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

_LOADED = {("script", "src"), ("img", "src"), ("link", "href"), ("iframe", "src"), ("source", "src")}
"""What a browser loads without being asked."""
_NOT_LOADED = {"canonical", "next", "prev", "index", "search", "genindex", "author"}
_EXTERNAL = re.compile(r"(?:https?://[\w.-]+(?::\d+)?(?:/\S*)?|mailto:\S+@\S+)\Z")


class _Page(HTMLParser):
    """The identifiers and the addresses of a page."""

    def __init__(self) -> None:
        super().__init__()
        self.identifiers: set[str] = set()
        self.links: list[str] = []
        self.loaded: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note what the tag refers to."""
        given = {name: value or "" for name, value in attrs}
        self.identifiers.update(given[name] for name in ("id", "name") if name in given)
        for name in ("href", "src"):
            if name not in given:
                continue
            is_loaded = (tag, name) in _LOADED and given.get("rel", "") not in _NOT_LOADED
            (self.loaded if is_loaded else self.links).append(given[name])


def complaints(folder: Path) -> list[str]:
    """A line for each dead link below a folder, and for each thing that a page would load from another place."""
    folder = folder.resolve()

    @cache
    def read(path: Path) -> _Page:
        page = _Page()
        page.feed(path.read_text(encoding="utf-8"))
        return page

    found = []
    for path in sorted(folder.rglob("*.html")):
        name = path.relative_to(folder)
        if name.parts[0] == "playground":
            continue
        page = read(path)
        found += [f"{name}: it loads {each}" for each in page.loaded if re.match(r"(?:https?:)?//", each)]
        for link in {*page.links, *page.loaded}:
            parts = urlsplit(link)
            if parts.scheme in ("http", "https", "mailto"):
                if not _EXTERNAL.match(link):
                    found.append(f"{name}: this is not an address: {link}")
                continue
            if parts.scheme or parts.netloc:
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            target = target / "index.html" if target.is_dir() else target
            if not target.is_relative_to(folder) or not target.exists():
                found.append(f"{name}: dead link {link}")
            elif (
                parts.fragment
                and target.suffix == ".html"
                and target.parent.name != "playground"
                and unquote(parts.fragment) not in read(target).identifiers
            ):
                found.append(f"{name}: there is no {link}")
    for path in sorted(folder.rglob("*.css")):
        for address in re.findall(r"(?:@import\s+|url\(\s*)[\"']?((?:https?:)?//[^\"')\s]+)", path.read_text("utf-8")):
            found.append(f"{path.relative_to(folder)}: it loads {address}")
    return found
