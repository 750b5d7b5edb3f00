"""Imports a generated package from memory.

The text of each module is registered with ``linecache``, so tracebacks and the places of faults show the generated code
as if it were on disk. The runtime is the installed one instead of the copy in the package: there is one runtime in a
process, compiled once.
"""

from __future__ import annotations

import importlib
import importlib.abc
import importlib.util
import itertools
import linecache
import sys
from collections.abc import Mapping, Sequence
from importlib.machinery import ModuleSpec
from types import ModuleType

_serial = itertools.count(1)


class _MemoryLoader(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Finds and loads the modules of one generated package."""

    def __init__(self, package: str, files: Mapping[str, str]) -> None:
        self._package = package
        self._files = files

    def _path(self, fullname: str) -> tuple[str, bool] | None:
        tail = fullname[len(self._package) :].lstrip(".").replace(".", "/")
        as_package = f"{tail}/__init__.py" if tail else "__init__.py"
        if as_package in self._files:
            return as_package, True
        as_module = f"{tail}.py"
        return (as_module, False) if as_module in self._files else None

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        if fullname != self._package and not fullname.startswith(f"{self._package}."):
            return None
        found = self._path(fullname)
        if found is None:
            return None
        file, is_package = found
        return importlib.util.spec_from_loader(fullname, self, origin=self._origin(file), is_package=is_package)

    def _origin(self, file: str) -> str:
        return f"<{self._package}>/{file}"

    def exec_module(self, module: ModuleType) -> None:
        found = self._path(module.__name__)
        assert found is not None
        file, _ = found
        origin, text = self._origin(file), self._files[file]
        module.__file__ = origin
        linecache.cache[origin] = (len(text), None, text.splitlines(keepends=True), origin)
        exec(compile(text, origin, "exec"), module.__dict__)


class LoadedPackage:
    """A generated package that was imported from memory; ``close`` forgets it."""

    def __init__(self, name: str, files: Mapping[str, str]) -> None:
        """Import ``files`` (paths as generated, below the folder ``name``) under a unique name."""
        prefix = f"{name}/"
        inside = {path.removeprefix(prefix): text for path, text in files.items() if path.startswith(prefix)}
        self.name = f"_cspdiag_{name}_{next(_serial)}"
        self._finder = _MemoryLoader(self.name, inside)
        sys.meta_path.insert(0, self._finder)
        self._share(importlib.import_module("cspdiag.runtime"))

    def _share(self, runtime: ModuleType) -> None:
        for module_name, module in sys.modules.copy().items():  # Another thread may import meanwhile.
            if module_name == runtime.__name__ or module_name.startswith(f"{runtime.__name__}."):
                sys.modules[f"{self.name}.runtime{module_name[len(runtime.__name__) :]}"] = module

    def module(self, name: str) -> ModuleType:
        """A module of the package, such as ``network`` or ``environments.bench``."""
        return importlib.import_module(f"{self.name}.{name}")

    def has(self, name: str) -> bool:
        """Whether the package has a module of this name."""
        return self._finder.find_spec(f"{self.name}.{name}", None) is not None

    def close(self) -> None:
        """Remove the package from the interpreter."""
        sys.meta_path.remove(self._finder)
        for module_name in [m for m in sys.modules.copy() if m == self.name or m.startswith(f"{self.name}.")]:
            del sys.modules[module_name]
        for origin in [o for o in linecache.cache.copy() if o.startswith(f"<{self.name}>/")]:
            del linecache.cache[origin]
