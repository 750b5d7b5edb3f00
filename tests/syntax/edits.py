"""Random changes of a text, as an engineer and an editor make them, the same for the same seed."""

from __future__ import annotations

import re
from collections.abc import Iterator
from random import Random

_PIECES = (
    *("/*", "*/", "//", "///", '"', "{", "}", "(", ")", "<", ">", "[", "]", ";", ":", "=", ".", "..", "->", "||", "[]"),
    *(
        "\n",
        "\r\n",
        "\r",
        "\t",
        " ",
        "\f",
        "\u2028",
        "\u00e9",
        "\u00b5",
        "\u2192",
        "\U0001f600",
        "\u00b2",
        "0x1F",
        "1_000",
    ),
    *("process", "submodel", "const", "parameter", "import", "type", "enum", "assert", "environment", "exception"),
    *("at", "offset", "step", "place", "free", "stop", "in", "out", "until", "else", "interrupt", "5 ", "ms", "s"),
    *("const extra = 1\n", "parameter gain = 2.5\n", "const at = 1\n", "const a = at\n", "const b = 5 ms\n"),
    *("/// A doc comment.\n", "// A comment.\n", "/* A comment. */", "process Extra {\n  composition { skip }\n}\n"),
    *(
        "import std.control\n",
        "exception Hot\n",
        "enum Mode { idle, run }\n",
        "\u00e4\u00f6 = 1\n",
        "state",
        "const state = 1\n",
    ),
)
_WORD = re.compile(r"\w+")


def versions(random: Random, text: str, count: int) -> Iterator[str]:
    """Versions of a text, each changed from the one before it, half of them so that they can hardly be read; sometimes
    changes are undone, also several at once.
    """
    history = [text]
    for _ in range(count):
        if len(history) > 1 and random.random() < 0.4:
            del history[max(1, len(history) - random.choice((1, 1, 2, 5))) :]
        else:
            history.append(random.choice((_damaged, changed))(random, history[-1]))
        yield history[-1]


_TOKEN = re.compile(r"[A-Za-z_]\w*|\d+(?:\.\d+)?|==|<=|[<+*]")


def changed(random: Random, text: str) -> str:
    """Another number, name or operator, or a line less: often a program with other mistakes, or none."""
    if random.random() < 0.2:
        lines = text.split("\n")
        del lines[random.randrange(len(lines))]
        return "\n".join(lines)
    places = list(_TOKEN.finditer(text))
    if not places:
        return text
    place = random.choice(places)
    alike = [each[0] for each in places if each[0][0].isdigit() == place[0][0].isdigit()]
    other = random.choice([*alike, "0", "7", "1e300"] if place[0][0].isdigit() else alike)
    return text[: place.start()] + other + text[place.end() :]


def _damaged(random: Random, text: str) -> str:
    start = random.randint(0, len(text))
    end = min(len(text), start + random.choice((0, 0, 1, 1, 2, 5, 30, 300)))
    match random.choice(("insert", "insert", "delete", "paste", "word", "two", "line", "append")):
        case "insert":
            return text[:start] + random.choice(_PIECES) + text[start:]
        case "delete":
            return text[:start] + text[max(end, start + 1) :]
        case "paste":
            place = random.randint(0, len(text))
            return text[:place] + text[start:end] + text[place:]
        case "word":
            found = _WORD.search(text, start)
            other = random.choice((random.choice(_PIECES), random.choice(_WORD.findall(text) or _PIECES)))
            return text if found is None else text[: found.start()] + other + text[found.end() :]
        case "two":
            # As a rename does: several places at once.
            return text[:start] + random.choice(_PIECES) + text[start:end] + random.choice(_PIECES) + text[end:]
        case "line":
            begin = text.rfind("\n", 0, start) + 1
            return text[:begin] + random.choice(("", " ", "\n")) + text[text.find("\n", start) + 1 :]
        case _:
            return random.choice((text + random.choice(_PIECES), random.choice(_PIECES) + text))
