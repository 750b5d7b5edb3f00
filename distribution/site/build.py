"""Builds the documentation site: ``build/site``, static files that any server or a folder shows.

python -m distribution.site.build
"""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

from distribution.site.book import browser, write_book
from distribution.site.links import complaints
from distribution.site.shell import CommandError
from distribution.site.stage import Site

ROOT = Path(__file__).parents[2]
BUILD = ROOT / "build"
OUT = BUILD / "site"
SOURCES = BUILD / "site-sources"
PLAYGROUND = ROOT / "studio" / "build"
CONFIGURATION = Path(__file__).parent / "sphinx"


def main() -> int:
    """Build the site; returns 1, and says why, if something of it is wrong."""
    from sphinx.cmd.build import build_main

    has_playground = all((PLAYGROUND / part).exists() for part in ("index.html", "worker.js", "engine"))
    printer = browser()
    site = Site(SOURCES, BUILD / "site-work", "linked" if has_playground else "absent", has_book=printer is not None)
    try:
        site.write()
    except CommandError as problem:
        print(problem, file=sys.stderr)
        return 1
    options = ["-W", "--keep-going", "-q", "-b", "html", "-c", str(CONFIGURATION), "-d", str(BUILD / "site-doctrees")]
    if build_main([*options, str(SOURCES), str(OUT)]):
        return 1
    shutil.rmtree(OUT / "playground", ignore_errors=True)
    if has_playground:
        shutil.copytree(PLAYGROUND, OUT / "playground")
    else:
        print("there is no playground: `make playground` makes it, and then programs get links that open them in it")
    if printer is not None:
        write_book(OUT, printer)
    else:
        print("there is no document to print: a browser prints it, for example that of the package chromium")
    if found := complaints(OUT):
        print("\n".join(found), file=sys.stderr)
        return 1
    print(f"{len(list(OUT.rglob('*.html')))} pages: {OUT.relative_to(ROOT)}/index.html")
    return 0


if __name__ == "__main__":
    sys.exit(main())
