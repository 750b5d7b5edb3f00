"""Macros in files by hand that would replace names in generated code, which is behind them where it is compiled, and
enumerators that have the names of constants.
"""

from __future__ import annotations

import posixpath
import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

from cspdiag.base.record import record, replaced
from cspdiag.codegen.c.interface.directives import divided, without_comments
from cspdiag.codegen.c.text.reserved import is_reserved
from cspdiag.codegen.shared.target_error import TargetError

_TEXT = re.compile(r"\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])*'")
_WORD = re.compile(r"\b([A-Za-z_]\w*)\b(\s*\()?")
_NAME = re.compile(r"\b[A-Za-z_]\w*\b")
_DEFINITION = re.compile(r"(\w+)(\(?)(.*)", re.DOTALL)
_ENUM = re.compile(r"\benum\s*\w*\s*\{([^{}]*)\}")
_ENUMERATOR = re.compile(r"(?:^|,)\s*(\w+)")
_CONSTANT = re.compile(r"static const [\w ]+?(\w+)(?:\[\d+\])* =")
_QUOTED = re.compile(r'"([^"]+)"')
_LONGEST = 100
"""Letters of a line that are shown."""


@record
class _Macro:
    """A macro in a file by hand, or in other files; ``body``: its text, ``line``: where it is."""

    name: str
    has_arguments: bool
    body: str
    path: str
    line: int


@record
class _Enumerator:
    """A name in an enumeration by hand, and where it is."""

    name: str
    path: str
    line: int


@record
class _Use:
    """A word in generated code, the line with it, and whether a bracket follows."""

    word: str
    shown: str
    is_called: bool


@record
class _Included:
    """Another file, at this place."""

    path: str


@record
class _Forgotten:
    """`#undef`."""

    name: str


_Step = _Macro | _Enumerator | _Use | _Included | _Forgotten


def refuse_colliding_macros(texts: Mapping[str, str], by_hand: Collection[str], owners: Iterable[str]) -> None:
    """Raises TargetError for each macro in a file ``by_hand`` that would replace a name in one of the other ``texts``
    that follows it, and for each enumerator with the name of a constant of the program.

    What begins with one of the ``owners``, the structs by hand, is theirs.
    """
    texts = {path: text for path, text in texts.items() if path.endswith((".c", ".h"))}
    own = tuple(f"{owner}_" for owner in owners)
    steps = {path: list(_by_hand(path, texts[path])) for path in by_hand if path in texts}
    names = {
        step.name
        for found in steps.values()
        for step in found
        if isinstance(step, _Macro | _Enumerator) and not is_reserved(step.name) and not step.name.startswith(own)
    }
    others = {path: text for path, text in texts.items() if path not in steps}
    if not any(name in text for text in others.values() for name in names):
        return
    generated = {path: list(_generated(path, text)) for path, text in others.items()}
    names |= _with_those_that_mean(names, [step for found in generated.values() for step in found])
    steps |= {
        path: [step for step in found if not isinstance(step, _Use) or step.word in names]
        for path, found in generated.items()
    }
    reasons: dict[str, str] = {}
    for path in sorted(steps):
        if path.endswith(".c"):
            for macro, reason in _collisions(path, steps, by_hand, names):
                reasons.setdefault(macro, reason)
    if reasons:
        raise TargetError("\n".join(reasons.values()))


def _by_hand(path: str, text: str) -> Iterator[_Step]:
    """What a file by hand does to macros. Whether a condition holds is not known."""
    plain, directives = divided(without_comments(text))
    for enum in _ENUM.finditer(plain):
        for entry in _ENUMERATOR.finditer(enum[1]):
            yield _Enumerator(entry[1], path, plain.count("\n", 0, enum.start(1) + entry.start(1)) + 1)
    for one in directives:
        if one.word == "include" and (quoted := _QUOTED.match(one.rest)):
            yield _Included(posixpath.basename(quoted[1]))
        elif one.word == "undef":
            yield _Forgotten(one.rest)
        elif one.word == "define" and (found := _DEFINITION.fullmatch(one.rest)):
            yield _Macro(found[1], bool(found[2]), found[3].strip(), path, one.line)


def _generated(path: str, text: str) -> Iterator[_Step]:
    """The words of a generated file or one of the kernel, its macros, and what it includes."""
    for row in without_comments(text).replace("\\\n", " ").split("\n"):
        stripped = row.strip()
        if stripped.startswith("#"):
            word, _, rest = stripped[1:].strip().partition(" ")
            if word == "include" and (quoted := _QUOTED.match(rest.strip())):
                yield _Included(quoted[1])
            elif word == "define" and (found := _DEFINITION.fullmatch(rest.strip())):
                yield _Macro(found[1], bool(found[2]), " ".join(_text_of(found).split()), path, 0)
        else:
            for found in _WORD.finditer(_TEXT.sub('""', row)):
                yield _Use(found[1], stripped, bool(found[2]))


def _text_of(definition: re.Match[str]) -> str:
    """The text of a macro, without its parameters, which are replaced before other macros."""
    if not definition[2]:
        return definition[3]
    parameters, _, body = definition[3].partition(")")
    own = {name.strip() for name in parameters.split(",")}
    return _NAME.sub(lambda found: "" if found[0] in own else found[0], body)


def _with_those_that_mean(names: Collection[str], steps: Sequence[_Step]) -> set[str]:
    """The macros of generated code in whose texts one of the names is, or another one of them."""
    macros = [(step.name, set(_NAME.findall(step.body)))
              for step in steps if isinstance(step, _Macro)]  # fmt: skip
    found: set[str] = set()
    while more := {name for name, words in macros if name not in found and not words.isdisjoint(found.union(names))}:
        found |= more
    return found


def _collisions(
    path: str, steps: Mapping[str, Sequence[_Step]], by_hand: Collection[str], names: Collection[str]
) -> Iterator[tuple[str, str]]:
    """The macros that replace something where a source is compiled, and why they are refused."""
    known: dict[str, _Macro] = {}
    enumerators: dict[str, _Enumerator] = {}
    for place, step in _in_order(path, steps, set()):
        match step:
            case _Macro() if step.name in names and step.body != step.name:
                before = known.get(step.name)
                is_other = before is not None and before.path == step.path and step.path not in by_hand
                known[step.name] = replaced(step, body=f"{before.body} {step.body}") if before and is_other else step
            case _Forgotten(name=name):
                known.pop(name, None)
            case _Enumerator():
                enumerators[step.name] = step
            case _Use():
                constant = _CONSTANT.match(step.shown)
                if constant and constant[1] == step.word and (same := enumerators.get(step.word)):
                    yield (
                        same.name,
                        (
                            f"{same.path}:{same.line}: the enumerator `{same.name}` has the name of a constant, "
                            f"`{step.shown}` of {place}\n  help: give it another name, such as `{_longer(same)}`"
                        ),
                    )
                for macro, shown, where in _replacing(step, place, known, by_hand):
                    yield macro.name, _reason(macro, shown, where)
            case _:  # Other macros, and files, which are in the order.
                continue


def _in_order(path: str, steps: Mapping[str, Sequence[_Step]], seen: set[str]) -> Iterator[tuple[str, _Step]]:
    """What a compiler reads, each with its file; every header once."""
    seen.add(path)
    for step in steps.get(path, ()):
        if not isinstance(step, _Included):
            yield path, step
        elif step.path not in seen:
            yield from _in_order(step.path, steps, seen)


def _replacing(
    use: _Use, place: str, known: Mapping[str, _Macro], by_hand: Collection[str]
) -> Iterator[tuple[_Macro, str, str]]:
    """The macros by hand that a word means, or that are in the texts of those that it means, and where."""
    pending, seen = [(use.word, use.is_called, use.shown, place)], set[str]()
    while pending:
        word, is_called, shown, where = pending.pop()
        macro = known.get(word)
        if macro is None or word in seen or (macro.has_arguments and not is_called):
            continue
        seen.add(word)
        if macro.path in by_hand:
            yield macro, shown, where
        else:
            text = f"#define {macro.name}{'(...)' if macro.has_arguments else ''} {macro.body}"
            words = _WORD.finditer(_TEXT.sub('""', macro.body))
            pending += [(found[1], bool(found[2]), text, macro.path) for found in words]


def _reason(macro: _Macro, shown: str, where: str) -> str:
    row = shown if len(shown) <= _LONGEST else f"{shown[:_LONGEST]}…"
    return (
        f"{macro.path}:{macro.line}: the macro `{macro.name}` would replace a name in `{row}` of {where}\n"
        f"  help: give it another name, such as `{_longer(macro)}`, or end it by `#undef {macro.name}`"
    )


def _longer(found: _Macro | _Enumerator) -> str:
    """A name that says of which file it is."""
    return f"{re.sub(r'[^A-Za-z0-9]+', '_', posixpath.splitext(found.path)[0])}_{found.name}".upper()
