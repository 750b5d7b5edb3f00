"""Whether what was generated is Python: no package is written that cannot be imported."""

from __future__ import annotations

from collections.abc import Mapping

from cspdiag.base.record import EMPTY
from cspdiag.codegen.shared.render import Replacement, TemplateError


def require_valid(files: Mapping[str, str], templates: Mapping[str, Replacement] = EMPTY) -> None:
    """Compiles the modules of a package, but for those that were written by hand, the runtime and devices.

    Raises TemplateError where the user's templates make something else than Python; without any, the SyntaxError is a
    mistake of the generator.
    """
    for path, text in files.items():
        if not path.endswith(".py") or any(f"/{folder}/" in path for folder in ("runtime", "external", "devices")):
            continue
        try:
            compile(text, path, "exec", dont_inherit=True)
        except SyntaxError as problem:
            if not templates:
                raise
            place = path if problem.lineno is None else f"{path}:{problem.lineno}"
            raise TemplateError(f"{place}: with these templates it is not Python: {problem.msg}") from None
