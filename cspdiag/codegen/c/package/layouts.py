"""A package as a library for a framework: the folders and manifests that it expects, made of the usual package."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from cspdiag.base.record import record
from cspdiag.codegen.c.package.folding import folded_script
from cspdiag.codegen.c.package.includes import with_headers
from cspdiag.codegen.shared.render import Render

SUPPORT = "support"
"""The folder of the kernel in a package."""

VERSION = "1.0.0"

LONGEST_DESCRIPTION = 200
"""Characters, less than any of the registries of libraries accepts."""

CONTRACTION_OFF = """\
#ifdef __GNUC__
#pragma GCC optimize("fp-contract=off") /* The values are defined to the last bit. */
#endif
"""


OWNERS = ("csp_run.c", "csp_platform.c")
"""Files of the kernel for programs that own their thread, which these libraries do not."""


@record
class Layout:
    """The templates of the manifests and the licence, by path, and whether a library can give options to the
    compiler.
    """

    manifests: Mapping[str, str]
    has_options: bool = True


LAYOUTS: Mapping[str, Layout] = {
    "zephyr": Layout(
        {
            "zephyr/module.yml": "zephyr_module.yml.j2",
            "zephyr/CMakeLists.txt": "zephyr_CMakeLists.txt.j2",
            "zephyr/Kconfig": "zephyr_Kconfig.j2",
            "LICENSE": "LICENSE.j2",
        }
    ),
    "esp-idf": Layout(
        {
            "CMakeLists.txt": "idf_CMakeLists.txt.j2",
            "idf_component.yml": "idf_component.yml.j2",
            "LICENSE": "LICENSE.j2",
        }
    ),
    "platformio": Layout({"library.json": "library.json.j2", "LICENSE": "LICENSE.j2"}),
    "arduino": Layout({"library.properties": "library.properties.j2", "LICENSE": "LICENSE.j2"}, has_options=False),
}
"""By the name of the framework."""


@record
class Library:
    """What the templates of manifests are given; ``sources`` are paths in the package, and so are those ``by_hand``, of
    processes and laws in C, whose licence is that of their authors.
    """

    package: str
    top: str
    source: str
    description: str
    version: str = VERSION
    sources: tuple[str, ...] = ()
    by_hand: tuple[str, ...] = ()


def arranged(
    framework: str, files: Mapping[str, str], described: Library, compiled: Collection[str], render: Render
) -> dict[str, str]:
    """The library for a framework, made of ``files``, the usual package: the interface in ``src/``, in a folder below
    it the sources that are ``compiled`` and the headers that they include, the README, and the manifests.
    """
    layout = LAYOUTS[framework]
    kept = with_headers([path for path in compiled if not path.endswith(OWNERS)], files, ("", SUPPORT))
    texts = {_moved(path, described.package): _with_options(path, files[path], layout) for path in kept}
    library = Library(
        described.package, described.top, described.source, _shortened(described.description),
        sources=tuple(sorted(path for path in texts if path.endswith(".c"))),
        by_hand=tuple(_moved(path, described.package) for path in kept if path in described.by_hand),
    )  # fmt: skip
    manifests = {path: folded_script(render(name, library=library)) for path, name in layout.manifests.items()}
    return dict(sorted({**texts, **manifests, "README.md": files["README.md"]}.items()))


def _moved(path: str, package: str) -> str:
    """The interface is where frameworks look for headers; the others find each other in one folder."""
    is_public = path in (f"{package}_api.h", f"{package}_types.h")
    return f"src/{path}" if is_public else f"src/{package}/{path.removeprefix(f'{SUPPORT}/')}"


def _with_options(path: str, text: str, layout: Layout) -> str:
    return text if layout.has_options or not path.endswith(".c") else CONTRACTION_OFF + text


def _shortened(text: str) -> str:
    return text if len(text) <= LONGEST_DESCRIPTION else f"{text[: LONGEST_DESCRIPTION - 1].rstrip()}…"
