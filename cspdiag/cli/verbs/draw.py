"""``cspdiag draw``: communication and composition diagrams as pictures."""

from __future__ import annotations

import os
import sys
from argparse import ArgumentParser, Namespace
from pathlib import Path
from typing import TYPE_CHECKING

from cspdiag.base.render.snippet import on_one_line
from cspdiag.base.sources import STANDARD_INPUT, read_source
from cspdiag.cli.support.failure import FINE, UNSUCCESSFUL, NoResultError, UsageError
from cspdiag.cli.support.files.written import given_name, require_different, require_file, require_folder
from cspdiag.cli.support.numbers import number, whole_number
from cspdiag.cli.support.terminal import say, show_diagnostics, write_out
from cspdiag.draw import exchange
from cspdiag.pipeline import check

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import networkx

    from cspdiag.draw.elements.communication import Drawn
    from cspdiag.draw.pictures import PictureOptions, Pictures
    from cspdiag.draw.scene.shapes import Scene

EXAMPLE = """cspdiag draw models/jiwy/jiwy.csp
cspdiag draw models/jiwy/jiwy.csp --process JointControl --diagram communication -o joint.pdf
cspdiag draw models/jiwy/jiwy.csp --all -o diagrams --hide-labels
cspdiag draw models/jiwy/jiwy.csp --book jiwy.html
cspdiag draw controller.csp --check -o review.svg
cspdiag draw models/jiwy/jiwy.csp -o jiwy.mmd"""
FORMATS = ("svg", "png", "pdf")


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("file", metavar="FILE", nargs="?", help="a program; - reads standard input")
    parser.add_argument(
        "-o",
        "--output",
        type=given_name,
        metavar="OUT",
        help=(
            "a file that ends in .svg, .png, .pdf, .dot, .mmd or .graphml, a folder, or - for standard output "
            "(default: PROCESS.svg; with --all the folder FILE-diagrams)"
        ),
    )
    parser.add_argument(
        "--format",
        choices=(*FORMATS, *exchange.FORMATS),
        help=(
            "the format, if the name of the output does not show it; dot, mermaid and graphml are the network as text"
        ),
    )
    what = parser.add_mutually_exclusive_group()
    what.add_argument(
        "--process",
        metavar="NAME",
        action="append",
        help="a process or an environment, may be repeated (default: the outermost process)",
    )
    what.add_argument(
        "--all",
        action="store_true",
        help=(
            "every process and environment of the file: as files in a folder, as pages of a PDF, or one below the "
            "other in an SVG or PNG"
        ),
    )
    what.add_argument(
        "--book",
        type=given_name,
        metavar="OUT.html",
        help=(
            "one self-contained page: every process with its diagrams, its text and its ports, and links between them"
        ),
    )
    parser.add_argument(
        "--diagram",
        choices=("communication", "composition", "both"),
        default="both",
        help="which diagram (default: both, one below the other)",
    )
    parser.add_argument(
        "--hide-labels",
        metavar="WHICH",
        nargs="?",
        action="append",
        const="all",
        help=(
            "leave out labels of the communication diagram: all, or some by their names or as labels, types, ports, "
            "periods, kinds, legend (leftmax,types)"
        ),
    )
    parser.add_argument(
        "--depth", metavar="N", type=whole_number, default=1, help="show the inside of instances, N levels (default: 1)"
    )
    parser.add_argument(
        "--check", action="store_true", help="mark errors and warnings; draw what can be read of a program with errors"
    )
    parser.add_argument(
        "--scheme",
        choices=("light", "dark", "auto"),
        default="auto",
        help="colours (default: auto, as the viewer prefers; light in PNG and PDF)",
    )
    parser.add_argument("--scale", type=number, default=2.0, help="dots per pixel in a PNG (default: 2)")


def run(arguments: Namespace) -> int:
    """Draw what was requested; a program with errors is drawn only to show them."""
    _find_file(arguments)
    require_different({"the program": arguments.file, "--book": arguments.book, "-o": arguments.output})
    _refuse_contradictions(arguments)
    if _format(arguments) in exchange.FORMATS:
        return _write_graph(arguments)
    if arguments.diagram != "composition":
        from cspdiag.draw.layout import engine

        engine.start()
    checked = check(read_source(arguments.file), read_source)
    found = checked.report.diagnostics
    show_diagnostics(found, arguments.color)
    code = UNSUCCESSFUL if checked.report.has_errors else FINE
    if checked.readable is None or (code != FINE and not arguments.check):
        return UNSUCCESSFUL

    from cspdiag.draw.layout.graph import LayoutError
    from cspdiag.draw.missing import MissingToolError
    from cspdiag.draw.pictures import Pictures

    pictures = Pictures(checked.readable, found if arguments.check else (), checked.analysis)
    try:
        _draw(arguments, pictures)
    except MissingToolError as problem:
        raise UsageError(str(problem)) from None
    except LayoutError as problem:
        raise NoResultError(str(problem)) from None
    return code


def _find_file(arguments: Namespace) -> None:
    """In ``--hide-labels FILE`` the argument was meant as the file, because a label has no suffix."""
    if arguments.file is not None:
        return
    hidden = arguments.hide_labels or [""]
    if not hidden[-1].endswith(".csp") and hidden[-1] != STANDARD_INPUT:
        raise UsageError("the following arguments are required: FILE (try cspdiag draw --help)")
    arguments.file, hidden[-1] = hidden[-1], "all"


def _refuse_contradictions(arguments: Namespace) -> None:
    if arguments.depth < 1:
        raise UsageError("--depth is at least 1")
    if not 0.1 <= arguments.scale <= 20:
        raise UsageError("--scale is between 0.1 and 20")
    output = arguments.output
    if arguments.book is not None:
        _refuse_book(arguments)
    if output is None or output == STANDARD_INPUT:
        return
    named = _format_of_name(output)
    if arguments.format is not None and named not in (None, arguments.format):
        raise UsageError(f"-o {output} contradicts --format {arguments.format}")
    if not _is_folder(arguments) and named is None and arguments.format is None:
        raise UsageError(
            f"-o {output}: the name must end in .svg, .png, .pdf, .dot, .mmd or .graphml, or give --format"
        )
    if not _is_folder(arguments):
        require_file("-o", output)
        return
    folder = os.path.dirname(output.rstrip(os.sep))
    if folder and not os.path.isdir(folder):
        raise UsageError(f"-o {output}: there is no folder {folder}")
    require_folder("-o", output)


def _refuse_book(arguments: Namespace) -> None:
    if arguments.output is not None or arguments.format is not None:
        raise UsageError("--book writes one page: -o and --format do not apply to it")
    if arguments.book != STANDARD_INPUT:
        require_file("--book", arguments.book, (".html",), any_case=True)


def _write_graph(arguments: Namespace) -> int:
    """Write the network of a process as text for other tools."""
    _refuse_for_graph(arguments)
    graph = _graph(arguments)
    if graph is None:
        return UNSUCCESSFUL
    from cspdiag.draw.exchange.formats import graph_text

    format_ = _format(arguments)
    data = graph_text(graph, format_).encode()
    if arguments.output == STANDARD_INPUT:
        write_out(data)
        return FINE
    ending = next(ending for ending, known in exchange.ENDINGS.items() if known == format_)
    own_name = f"{graph.graph['name']}.{ending}"
    folder = _folder(arguments) if _is_folder(arguments) else None
    name = arguments.output or own_name if folder is None else os.fspath(folder / own_name)
    if name != arguments.output:
        _refuse_link(Path(name))
    if folder is None:
        _write(Path(name), data)
    else:
        _write_in_folder(folder, {Path(name): data})
    say(f"wrote {on_one_line(name)}")
    return FINE


def _refuse_for_graph(arguments: Namespace) -> None:
    """Refuse options that only apply to pictures."""
    unused = {
        "--all": arguments.all,
        "--book": arguments.book is not None,
        "--check": arguments.check,
        "--diagram": arguments.diagram != "both",
        "--hide-labels": arguments.hide_labels is not None,
        "--depth": arguments.depth != 1,
        "--scheme": arguments.scheme != "auto",
        "--scale": arguments.scale != 2.0,
    }
    for option, given in unused.items():
        if given:
            raise UsageError(f"{option} is for pictures: {_format(arguments)} has the whole network as text")
    if len(arguments.process or ()) > 1:
        raise UsageError(f"--process: {_format(arguments)} has the network of one process")


def _graph(arguments: Namespace) -> networkx.MultiDiGraph | None:
    from cspdiag.network.lower.program import SelectionError
    from cspdiag.pipeline import build

    (top,) = arguments.process or (None,)
    try:
        built = build(read_source(arguments.file), read_source, top=top)
    except SelectionError as problem:
        raise UsageError(str(problem)) from None
    show_diagnostics(built.checked.report.diagnostics, arguments.color)
    if built.network is None:
        return None
    from cspdiag.draw.exchange.network_graph import network_graph

    return network_graph(built.network)


def _write_book(arguments: Namespace, pictures: Pictures) -> None:
    from cspdiag.draw.book.page import book

    page = book(pictures).encode()
    if arguments.book == STANDARD_INPUT:
        write_out(page)
        return
    _write(Path(arguments.book), page)
    say(f"wrote {on_one_line(arguments.book)}")


def _draw(arguments: Namespace, pictures: Pictures) -> None:
    if arguments.book is not None:
        _write_book(arguments, pictures)
        return
    definitions = _chosen(arguments, pictures)
    options = _picture_options(arguments, pictures, definitions)
    scenes = {definition.name.text: pictures.scene(definition, options) for definition in definitions}
    format_ = _format(arguments)
    if _is_folder(arguments):
        _write_folder(
            _folder(arguments),
            {name: _rendered([scene], format_, arguments) for name, scene in scenes.items()},
            format_,
        )
        return
    data = _rendered(list(scenes.values()), format_, arguments)
    if arguments.output == STANDARD_INPUT:
        if format_ != "svg" and sys.stdout.isatty():
            raise UsageError(f"-o -: a {format_.upper()} cannot be written to a terminal")
        write_out(data)
        return
    name = arguments.output or f"{next(iter(scenes))}.{format_}"
    if arguments.output is None:
        _refuse_link(Path(name))
    _write(Path(name), data)
    say(f"wrote {on_one_line(name)}")


def _chosen(arguments: Namespace, pictures: Pictures) -> list[Drawn]:
    """The diagrams to draw; with --check also those that diagnostics refer to."""
    if arguments.all:
        chosen = pictures.drawn()
    elif arguments.process:
        chosen = [_named(pictures, name) for name in dict.fromkeys(arguments.process)]
    else:
        outermost = pictures.outermost()
        chosen = [] if outermost is None else [outermost]
        concerned = [definition for definition in pictures.drawn(imported=True) if pictures.concerned(definition)]
        chosen = [*concerned, *(definition for definition in chosen if not concerned)]
    if not chosen:
        raise NoResultError(f"{on_one_line(arguments.file)} has no process to draw")
    return chosen


def _named(pictures: Pictures, name: str) -> Drawn:
    found = pictures.named(name)
    if found is None:
        from cspdiag.network.lower.program import suggestion

        known = [each.name.text for each in pictures.drawn(imported=True)]
        raise UsageError(f"there is no process or environment `{name}`{suggestion(name, known)}")
    return found


def _picture_options(arguments: Namespace, pictures: Pictures, definitions: Sequence[Drawn]) -> PictureOptions:
    from cspdiag.draw.hiding import ALL_LABELS, hidden
    from cspdiag.draw.pictures import PictureOptions

    hide = hidden(arguments.hide_labels or ())
    if "all" in hide.names:
        hide = ALL_LABELS
    unknown = sorted(hide.names - pictures.labels(definitions, arguments.depth))
    if unknown:
        raise UsageError(f"--hide-labels: there is no label `{unknown[0]}` in what is drawn")
    return PictureOptions(which=arguments.diagram, hidden=hide, depth=arguments.depth)


def _format(arguments: Namespace) -> str:
    if arguments.format is not None:
        return str(arguments.format)
    return (None if arguments.output is None else _format_of_name(arguments.output)) or "svg"


def _format_of_name(output: str) -> str | None:
    suffix = Path(output).suffix.removeprefix(".").lower()
    return suffix if suffix in FORMATS else exchange.ENDINGS.get(suffix)


def _is_folder(arguments: Namespace) -> bool:
    """Whether each picture becomes a file of a folder."""
    output = arguments.output
    if output == STANDARD_INPUT:
        return False
    if output is None:
        return bool(arguments.all)
    return output.endswith(os.sep) or os.path.isdir(output) or (bool(arguments.all) and not Path(output).suffix)


def _folder(arguments: Namespace) -> Path:
    if arguments.output is not None:
        return Path(arguments.output)
    stem = "program" if arguments.file == STANDARD_INPUT else Path(arguments.file).stem
    return Path(f"{stem}-diagrams")


def _rendered(scenes: Sequence[Scene], format_: str, arguments: Namespace) -> bytes:
    from cspdiag.draw.output.formats import rendered

    return rendered(scenes, format_, arguments.scheme, arguments.scale)


def _write_folder(folder: Path, files: Mapping[str, bytes], format_: str) -> None:
    places = {folder / f"{name}.{format_}": data for name, data in files.items()}
    for place in places:
        _refuse_link(place)
    _write_in_folder(folder, places)
    pictures = "1 picture" if len(files) == 1 else f"{len(files)} pictures"
    say(f"wrote {pictures} to {on_one_line(folder)}")


def _write_in_folder(folder: Path, files: Mapping[Path, bytes]) -> None:
    from cspdiag.base.files.whole import replace_files

    replace_files({os.fspath(path): data for path, data in files.items()}, folder)


def _refuse_link(path: Path) -> None:
    """A file that the user has named may be a link; one that is named after a process is not written elsewhere."""
    if path.is_symlink():
        raise UsageError(f"{path} is a symbolic link: remove it, or name the file with -o")


def _write(path: Path, data: bytes) -> None:
    from cspdiag.base.files.whole import write_whole

    write_whole(path, data)
