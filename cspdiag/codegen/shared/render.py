"""The templates of a target."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

from cspdiag.base.resources import template_folder


@cache
def renderer(target: str) -> Callable[..., str]:
    """``render(template, **values)`` for the templates of a target; a value that a template misses is an error."""
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    environment = Environment(
        loader=FileSystemLoader(template_folder(target)),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=False,
    )

    def render(template: str, **values: object) -> str:
        return environment.get_template(template).render(values)

    return render
