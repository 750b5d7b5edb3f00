"""How Sphinx makes the site; the sources are staged by ``distribution/site/build.py``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from docutils import nodes
from pygments.lexers.special import TextLexer
from sphinx.addnodes import index
from sphinx.transforms import SphinxTransform

import cspdiag
from distribution.site.highlighting import CspLexer

if TYPE_CHECKING:
    from sphinx.application import Sphinx

project = "cspdiag"
author = "the cspdiag project"
release = version = cspdiag.__version__
extensions = ["myst_parser", "sphinx.ext.autodoc"]
language = "en"
templates_path = ["templates"]
nitpicky = False

myst_enable_extensions = ["attrs_inline"]
myst_heading_anchors = 4
myst_links_external_new_tab = False
# A numbered list that continues after a block.
suppress_warnings = ["myst.header"]

autodoc_typehints = "signature"
autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
python_use_unqualified_type_names = True

html_theme = "furo"
html_title = "cspdiag"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_js_files = ["site.js", "search.js"]
html_copy_source = False
html_show_sourcelink = False
html_show_sphinx = False
html_show_copyright = False
html_favicon = "static/favicon.svg"
html_theme_options = {"navigation_with_keys": False}
pygments_style = "a11y-high-contrast-light"
pygments_dark_style = "a11y-high-contrast-dark"


class Keywords(SphinxTransform):
    """Keywords of a page lead to its beginning, and not to a mark above it that contains nothing."""

    default_priority = 200  # Before docutils gives the mark to what follows it, and Sphinx collects the words.

    def apply(self, **given: Any) -> None:
        """Take the marks away."""
        marks = [mark for mark in self.document.findall(nodes.target) if mark["ids"][:1] and _is_mark(mark["ids"][0])]
        for mark in marks:
            mark.parent.remove(mark)
        for each in self.document.findall(index):
            each["entries"] = [
                (kind, word, "" if _is_mark(target) else target, main, key)
                for kind, word, target, main, key in each["entries"]
            ]


def _is_mark(identifier: str) -> bool:
    return identifier.startswith("index-")


def setup(app: Sphinx) -> None:
    """Highlight programs, and find pages by their keywords."""
    app.add_transform(Keywords)
    for name in CspLexer.aliases:
        app.add_lexer(name, CspLexer)
    app.add_lexer("trace", TextLexer)
