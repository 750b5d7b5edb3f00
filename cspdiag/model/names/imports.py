"""The files of a program: the main one and everything it imports."""

from __future__ import annotations

import posixpath
from collections.abc import Callable, Iterator

from cspdiag.base import Report, SourceFile
from cspdiag.base.files import resources
from cspdiag.model.diagnostics.imports import ImportCycle, UnknownLibrary, UnreadableFile
from cspdiag.syntax import ast
from cspdiag.syntax.on_demand import parsed


def load(
    main: SourceFile,
    read: Callable[[str], SourceFile],
    report: Report,
    parse: Callable[[SourceFile, Report], ast.SourceTree] = parsed,
) -> list[ast.SourceTree]:
    """Parse a program and everything it imports, each file once; the main file comes first.

    ``read`` is called with the path of an imported file, relative to the same folder as the name of the main file, and
    raises OSError if it cannot read it. ``parse`` gives the tree of a file. Files that cannot be parsed are left out.
    """
    trees: dict[str, ast.SourceTree | None] = {main.name: parse(main, report)}
    # The files from the main file to the present one, each with its imports that have not been followed yet.
    path = [(main.name, _imports(trees[main.name]))]
    while path:
        importer, pending = path[-1]
        statement = next(pending, None)
        if statement is None:
            path.pop()
            continue
        name = file_name(importer, statement)
        if name in [file for file, _ in path]:
            cycle = (*(file for file, _ in path[[file for file, _ in path].index(name) :]), name)
            report.add(ImportCycle(statement.span, cycle=cycle))
        elif name not in trees:
            source = _open(name, statement, read, report)
            trees[name] = parse(source, report) if source else None
            path.append((name, _imports(trees[name])))
    return [tree for tree in trees.values() if tree is not None]


def _imports(tree: ast.SourceTree | None) -> Iterator[ast.Import]:
    return iter([item for item in tree.items if isinstance(item, ast.Import)] if tree else [])


def file_name(importer: str, statement: ast.Import) -> str:
    """The name of an imported file, from that of the file that imports it."""
    if statement.library is not None:
        return statement.library.replace(".", "/") + ".csp"
    return posixpath.normpath(posixpath.join(posixpath.dirname(importer), statement.path or ""))


def _open(name: str, statement: ast.Import, read: Callable[[str], SourceFile], report: Report) -> SourceFile | None:
    if statement.library is not None:
        text = resources.library_source(statement.library)
        if text is None:
            report.add(UnknownLibrary(statement.span, library=statement.library))
            return None
        return SourceFile(name=name, text=text)
    missing = False
    try:
        return read(name)
    except OSError as error:
        missing = isinstance(error, FileNotFoundError | NotADirectoryError)
        reason = error.strerror or str(error)
    except UnicodeDecodeError:
        reason = "it is not a text file"
    except ValueError as error:
        reason = str(error)
    report.add(UnreadableFile(statement.span, path=statement.path or "", file=name, missing=missing, reason=reason))
    return None
