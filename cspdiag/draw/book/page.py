"""The page of a program, complete in one file."""

from __future__ import annotations

import os
from itertools import groupby

from cspdiag import __version__
from cspdiag.base.files.resources import template_folder
from cspdiag.draw.book.chapters import anchor, chapters, declarations
from cspdiag.draw.output.svg import custom_properties, ink_rules, visible
from cspdiag.draw.pictures import Pictures
from cspdiag.draw.scene.palette import MONO, SANS, Scheme


def _visible(value: object) -> object:
    """Text from outside in a form that can be shown; markup is made here, and needs no treatment."""
    return visible(value) if type(value) is str else value


def book(pictures: Pictures) -> str:
    """The page: every process and environment with both diagrams, submodels and drivers, their texts, ports and
    parameters, and links between them.

    Raises the same exceptions as ``lay_out``.
    """
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    environment = Environment(
        loader=FileSystemLoader(template_folder("draw")),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=True,
        finalize=_visible,
    )
    described = chapters(pictures)
    links = {chapter.name: f"#{anchor(chapter.name)}" for chapter in described}
    source = pictures.program.main.source.name
    return environment.get_template("book.html").render(
        title=os.path.basename(source).removesuffix(".csp"),
        file=os.path.basename(source),
        version=__version__,
        sections=[(name, list(group)) for name, group in groupby(described, key=lambda chapter: chapter.section)],
        declarations=declarations(pictures.program, links),
        links=links,
        light=custom_properties(Scheme.LIGHT),
        dark=custom_properties(Scheme.DARK),
        rules=ink_rules(),
        sans=SANS,
        mono=MONO,
    )
