"""Writes the sources of the site: every page of ``contents.SECTIONS`` in its place, with links that fit."""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Iterator
from pathlib import Path

from distribution.site import front, generated
from distribution.site.book import NAME as BOOK
from distribution.site.contents import GALLERY, KEYWORDS, PICTURES, REFERENCE, RUN, SECTIONS, Entry, Section
from distribution.site.markdown import Page, Playground, converted, fenced, play_link, prose, relative
from distribution.site.pictures import dark, light
from distribution.site.playground import program_of
from distribution.site.shell import Shell

ROOT = Path(__file__).parents[2]
REPOSITORY = "https://github.com/cspdiag/cspdiag"
"""Where links to files lead that are not on the site."""

_PLACES = {
    "README.md": "index",
    "docs/diagnostics.md": f"{generated.DIAGNOSTICS}/index",
    "models": "gallery/index",
    "docs": "index",
}
_FILE_NAME = re.compile(r"\[(?P<file>[\w./-]+\.md)\]\((?P<place>[\w./-]+)\.md(?P<anchor>#[^)]*)?\)")
_ENTRIES = tuple(entry for section in SECTIONS for group in section.groups for entry in group.entries)


class Site:
    """The sources of the site in a folder. Files that did not change keep their times, so Sphinx reads the others."""

    def __init__(self, folder: Path, work: Path, playground: Playground = "linked", *, has_book: bool = False) -> None:
        self.folder = folder
        self.work = work
        self.playground: Playground = playground
        self.has_book = has_book
        self._names = {entry.place: entry.name for entry in _ENTRIES}
        self.pages: list[Page] = []
        self._written: set[Path] = set()
        self._places = _PLACES | {entry.source: entry.place for entry in _ENTRIES if entry.source}
        self._places |= {f"docs/design/{page.name}": f"explanations/design/{page.stem}" for page in _decisions()}
        self._places |= {f"models/{page.parent.name}": f"gallery/{page.parent.name}" for page in _models()}

    def write(self) -> None:
        """Write all pages, and remove what is there from before."""
        self.save("index.md", front.page(self.page_at("index"), Shell(self.work / "index")))
        for entry in _ENTRIES:
            if entry.source:
                self.save(f"{entry.place}.md", self.page(entry))
        for section in SECTIONS:  # With pictures that the commands of their pages have made.
            self.save(f"{section.folder}/index.md", self._index(section))
        for path in _decisions():
            place = f"explanations/design/{path.stem}"
            if path.stem != "README":
                self.save(f"{place}.md", self.page(Entry(f"docs/design/{path.name}", place, "", "")))
        self.save("reference/commands.md", generated.commands())
        self.save("reference/python-api.md", generated.python_api())
        for page, text in generated.diagnostics(self._of_manual, self.linked):
            self.save(f"{page.place}.md", text)
        for path in self.folder.rglob("*"):
            if path.is_file() and path not in self._written:
                path.unlink()

    def page_at(self, place: str, source: Path = ROOT) -> Page:
        """A page that is made for this site."""
        page = Page(source, place, playground=self.playground)
        self.pages.append(page)
        return page

    def _of_manual(self, place: str) -> Page:
        """A page of the manual, which belongs to ``docs/diagnostics.md`` in the repository."""
        return self.page_at(place, ROOT / "docs" / "diagnostics.md")

    def linked(self, page: Page, text: str) -> str:
        """Prose with links that fit the site."""
        return prose(page, text, self.resolve, self.show)

    def page(self, entry: Entry) -> str:
        """A page of the repository for the site."""
        path = ROOT / entry.source
        page = self.page_at(entry.place, path)
        if entry.source.startswith(RUN):
            page.shell = Shell(self.work / entry.place.replace("/", "-"))
        text = self._named(page, converted(page, path.read_text(encoding="utf-8"), self.resolve, self.show))
        if entry.source.startswith("models/"):
            text += self._texts(page, path.parent)
        if entry.place in KEYWORDS:
            text = f"```{{index}} {KEYWORDS[entry.place]}\n```\n\n{text}"
        if entry.place == "explanations/design/README":
            text += _toctree([(path.stem, "") for path in _decisions() if path.stem != "README"])
        return text

    def resolve(self, page: Page, target: str) -> str:
        """Where a link of a page leads on the site."""
        path, _, anchor = target.partition("#")
        if "://" in target or target.startswith("mailto:") or not path:
            return target
        file = (page.source.parent / path).resolve()
        if not file.is_relative_to(ROOT) or not file.exists():
            return target
        name = file.relative_to(ROOT).as_posix()
        if name == "docs/diagnostics.md" and (code := re.match(r"[ew]\d{4}", anchor)):
            return relative(f"{generated.DIAGNOSTICS}/{code[0].upper()}.md", page)
        if name in self._places:
            return relative(f"{self._places[name]}.md", page) + (f"#{anchor}" if anchor else "")
        if file.suffix == ".csp" and f"{Path(name).parent.as_posix()}/README.md" in self._places:
            of_model = self._places[f"{Path(name).parent.as_posix()}/README.md"]
            return relative(f"{of_model}.md", page) + f"#{file.name.replace('.', '').lower()}"
        kind = "tree" if file.is_dir() else "blob"
        return f"{REPOSITORY}/{kind}/main/{name}" + (f"#{anchor}" if anchor else "")

    def show(self, page: Page, text: str, target: str) -> str | None:
        """Markdown that shows a picture of the repository, or one that a command of the page has made."""
        file = page.source.parent / target
        if not file.exists() and page.shell is not None and target in page.shell:
            file = page.shell.folder / target
        if not file.exists():
            return None
        content = file.read_bytes()
        name = f"{file.stem}-{hashlib.sha256(content).hexdigest()[:8]}"
        if file.suffix != ".svg":
            return f"![{text}]({relative(self._store(f'{name}{file.suffix}', content), page)}){{.on-paper}}"
        svg = content.decode()
        for_dark = dark(svg)
        shown = relative(self._store(f"{name}.svg", light(svg).encode()), page)
        if for_dark is None:
            return f"![{text}]({shown}){{.on-paper}}"
        in_dark = relative(self._store(f"{name}-dark.svg", for_dark.encode()), page)
        return f"![{text}]({shown}){{.only-light}}![{text}]({in_dark}){{.only-dark}}"

    def _store(self, name: str, content: bytes) -> str:
        self.save(f"pictures/{name}", content)
        return f"pictures/{name}"

    def save(self, name: str, text: str | bytes) -> None:
        """Write a file of the site below its folder, if it differs from what is there."""
        path = self.folder / name
        content = text.encode() if isinstance(text, str) else text
        path.parent.mkdir(parents=True, exist_ok=True)
        if not path.exists() or path.read_bytes() != content:
            path.write_bytes(content)
        self._written.add(path)

    def _index(self, section: Section) -> str:
        """The first page of a section: what is in it, for those who do not know it yet."""
        page = self.page_at(f"{section.folder}/index")
        parts = [f"# {section.name}\n\n{section.introduction}\n"]
        if self.has_book and section is REFERENCE:
            parts.append(
                f'The language, its notation and its semantics are also <a href="../{BOOK}">a document to print</a>.\n'
            )
        for group in section.groups:
            heading = f"## {group.title}\n\n" if group.title else ""
            rows = "".join(self._row(page, entry) for entry in group.entries)
            cards = f'<div class="cards">\n\n{rows}\n</div>\n' if section is GALLERY else rows
            parts.append(heading + cards)
            parts.append(_toctree([(relative(entry.place, page), entry.name) for entry in group.entries], group.title))
        return "\n".join(parts)

    def _row(self, page: Page, entry: Entry) -> str:
        """A page in the list of a section, with its picture if it has one."""
        row = f"- **[{entry.name}]({relative(f'{entry.place}.md', page)})**  \n  {entry.about}\n"
        picture = PICTURES.get(Path(entry.place).name) if entry.place.startswith("gallery/") else None
        if picture is None:
            return row
        shell = next((each.shell for each in self.pages if each.place == entry.place), None)
        seen_from = Page(ROOT / "docs" / "index.md", page.place, shell)
        return f"{row}\n  {self.show(seen_from, entry.name, picture)}\n"

    def _named(self, page: Page, text: str) -> str:
        """The text with links that name pages as the navigation does, and not as files."""

        def named(found: re.Match[str]) -> str:
            place = os.path.normpath(Path(page.place).parent / found["place"])
            name = self._names.get(place, found["file"])
            return f"[{name}]({found['place']}.md{found['anchor'] or ''})"

        return _FILE_NAME.sub(named, text)

    def _texts(self, page: Page, folder: Path) -> str:
        """The programs of a model, whole, each with a link to the playground."""
        parts = ["\n## The text\n"]
        for path in sorted(folder.glob("*.csp")):
            text = path.read_text(encoding="utf-8")
            parts.append(f"### {path.name}\n\n{fenced(text, 'csp')}{play_link(page, *program_of(path))}")
        return "\n".join(parts)


def _toctree(rows: list[tuple[str, str]], caption: str = "") -> str:
    lines = "\n".join(f"{name} <{place}>" if name else place for place, name in rows)
    return f"\n```{{toctree}}\n:hidden:\n{f':caption: {caption}{chr(10)}' if caption else ''}\n{lines}\n```\n"


def _decisions() -> list[Path]:
    return sorted((ROOT / "docs" / "design").glob("*.md"))


def _models() -> Iterator[Path]:
    return (ROOT / "models").glob("*/README.md")
