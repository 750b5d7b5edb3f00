"""The templates of a target, and those that a user has supplied instead."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import cache
from typing import TYPE_CHECKING, Any

from cspdiag.base.files.resources import template_folder
from cspdiag.base.record import EMPTY, field_names, is_record, record
from cspdiag.codegen.shared.plain_text import one_line
from cspdiag.codegen.shared.target_error import TargetError

if TYPE_CHECKING:
    from jinja2 import Environment

SUFFIX = ".j2"
ORIGINAL = "original/"
"""The prefix of a template's name for the one that comes with cspdiag, even if it is replaced."""

PART = "_"
"""The first character of the names of files that templates include, and that are not templates themselves."""

Render = Callable[..., str]


@record
class Replacement:
    """A template that replaces one of cspdiag: its text, and where that comes from."""

    path: str
    text: str


class TemplateError(TargetError):
    """A mistake in a template of the user; the message has its place."""


def template_names(target: str) -> tuple[str, ...]:
    """The templates of a target, which can be replaced; empty for a target without templates."""
    folder = template_folder(target)
    return tuple(sorted(path.name for path in folder.iterdir() if path.suffix == SUFFIX)) if folder.is_dir() else ()


def renderer(target: str, replacements: Mapping[str, Replacement] = EMPTY) -> Render:
    """``render(template, **values)`` for the templates of a target; a value that is missing in a template is an error.

    Raises TemplateError for a mistake in one of the ``replacements``, by name: here for errors of syntax, in ``render``
    for those that occur when the template is used.
    """
    return _replacing(target, replacements) if replacements else _plain(target)


@cache
def _plain(target: str) -> Render:
    environment = _environment(target, EMPTY)

    def render(template: str, **values: object) -> str:
        return environment.get_template(template).render(values)

    return render


def _replacing(target: str, replacements: Mapping[str, Replacement]) -> Render:
    from jinja2 import TemplateSyntaxError

    environment = _environment(target, replacements)
    for name, replacement in replacements.items():
        try:
            environment.get_template(name)
        except TemplateSyntaxError as problem:
            raise TemplateError(f"{one_line(replacement.path)}:{problem.lineno}: {problem.message}") from None

    def render(template: str, **values: object) -> str:
        try:
            return environment.get_template(template).render(values)
        except Exception as problem:
            place = _place(problem, replacements)
            if place is None:
                raise
            raise TemplateError(f"{place}: {_reason(problem, values)}") from None

    return render


def _environment(target: str, replacements: Mapping[str, Replacement]) -> Environment:
    from jinja2 import Environment, FileSystemLoader, FunctionLoader, PrefixLoader, StrictUndefined

    own = FileSystemLoader(template_folder(target))
    placed = PrefixLoader({ORIGINAL.rstrip("/"): own})

    def load(name: str) -> tuple[str, str | None, Callable[[], bool] | None]:
        if name in replacements:
            return replacements[name].text, replacements[name].path, None
        return (placed if name.startswith(ORIGINAL) else own).get_source(environment, name)

    environment = Environment(
        loader=FunctionLoader(load),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=False,
    )
    return environment


def _place(problem: Exception, replacements: Mapping[str, Replacement]) -> str | None:
    """The innermost line of a replacement that was being rendered; None if the mistake is elsewhere."""
    paths = {replacement.path for replacement in replacements.values()}
    found = None
    for path, line in _frames(problem):
        if path in paths:
            found = f"{one_line(path)}:{line}"
    return found


def _frames(problem: Exception) -> Iterator[tuple[str, int]]:
    trace = problem.__traceback__
    while trace is not None:
        yield trace.tb_frame.f_code.co_filename, trace.tb_lineno
        trace = trace.tb_next


def _reason(problem: Exception, values: Mapping[str, object]) -> str:
    from jinja2 import TemplateNotFound, UndefinedError

    if isinstance(problem, TemplateNotFound):
        return f"there is no template {problem.name} to include"
    if isinstance(problem, UndefinedError):
        return _missing(str(problem), values)
    if isinstance(problem, RecursionError):
        return f"the template includes itself (the one of cspdiag is {ORIGINAL}NAME)"
    return f"{type(problem).__name__}: {problem}"


def _missing(message: str, values: Mapping[str, Any]) -> str:
    """What is missing, and what is available instead."""
    for name, value in values.items():
        shown = f"{type(value).__module__}.{type(value).__qualname__} object"
        if is_record(value) and shown in message:
            missing = message.rpartition("attribute ")[2].strip("'")
            return f"`{name}` has no `{missing}`; it has: {', '.join(field_names(value))}"
    given = ", ".join(values) or "nothing"
    return f"{message.replace(chr(39), '`')}; the template is given: {given}"
