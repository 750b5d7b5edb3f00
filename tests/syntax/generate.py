"""Random programs that are syntactically correct; their names mean nothing.

``program`` gives lists of tokens, ``text_of`` writes them with ordinary space in between, ``sprinkled`` with any space
and comments.
"""

from __future__ import annotations

from random import Random

NAMES = ["alpha", "b", "feedback", "servo", "x", "y2", "cell", "Motor", "Tsh", "status", "step", "free"]
TYPES = [["double"], ["double", "<rad/s>"], ["int"], ["bool"], ["Pose"], ["time"], ["int", "[", "3", "]"]]
NUMBERS = ["0", "12", "0.5", "1e-3", "3<V>", "9.81<m/s^2>", "5 ms", "2s", "1 kHz", "100\tns"]


class Generator:
    """Derives random token lists from the language; ``depth`` bounds their nesting."""

    def __init__(self, random: Random) -> None:
        self.random = random

    def name(self) -> str:
        return self.random.choice(NAMES)

    def maybe(self, *tokens: str | list[str]) -> list[str]:
        return flat(*tokens) if self.random.random() < 0.4 else []

    def separated(self, separator: str, make: object, least: int = 1, most: int = 4) -> list[str]:
        assert callable(make)
        tokens: list[str] = []
        for position in range(self.random.randint(least, most)):
            tokens += ([separator] if position else []) + make()
        return tokens

    def time(self) -> list[str]:
        """An expression that does not begin with a bracket, because a name may precede it, to which a bracket would
        belong.
        """
        found = self.expression(1)
        return ["5 ms"] if found[0] == "[" else found

    def expression(self, depth: int = 3) -> list[str]:
        r = self.random
        if depth == 0 or r.random() < 0.3:
            return [r.choice([self.name(), r.choice(NUMBERS), "true", "false", "stop"])]
        inner = depth - 1
        match r.randrange(9):
            case 0:
                return ["(", *self.expression(inner), ")"]
            case 1:
                operator = r.choice(["+", "-", "*", "/", "%", "^", "and", "or", "==", "<", ">="])
                return ["(", *self.operand(inner), operator, *self.operand(inner), ")"]
            case 2:
                return self.separated(r.choice(["+", "*", "and", "-"]), lambda: self.operand(inner), 2, 6)
            case 3:
                return [r.choice(["-", "not"]), *self.operand(inner)] if r.random() < 0.5 else ["-", self.name()]
            case 4:
                return [self.name(), "(", *self.arguments(inner), ")"]
            case 5:
                return [self.name(), "[", *self.expression(inner), "]", ".", self.name()]
            case 6:
                return flat(
                    "(",
                    "if",
                    self.expression(inner),
                    "then",
                    self.expression(inner),
                    "else",
                    self.expression(inner),
                    ")",
                )
            case 7:
                return ["[", *self.separated(",", lambda: self.expression(inner)), "]"]
            case _:
                return [self.name(), ".", self.name()]

    def operand(self, depth: int) -> list[str]:
        return (
            ["(", *self.expression(depth), ")"]
            if self.random.random() < 0.3
            else [self.random.choice([self.name(), "2"])]
        )

    def arguments(self, depth: int = 2) -> list[str]:
        if self.random.random() < 0.2:
            return []
        return self.separated(",", lambda: self.maybe(self.name(), "=") + self.expression(depth))

    def type_name(self) -> list[str]:
        return self.random.choice(TYPES)

    def reference(self) -> list[str]:
        tokens = [self.name()]
        if self.random.random() < 0.2:
            tokens += ["[", *self.expression(1), "]"]
        if self.random.random() < 0.4:
            tokens += [".", self.name()]
        return tokens

    def ports(self) -> list[str]:
        r = self.random
        tokens: list[str] = []
        for _ in range(r.randint(0, 4)):
            tokens += [r.choice(["in", "out"])]
            tokens += self.separated(",", lambda: [self.name(), *self.maybe("[", "N", "]")], 1, 3)
            tokens += [":", *self.type_name(), *self.maybe("=", self.expression(1))]
            tokens += self.maybe("@", self.expression(1), self.maybe("offset", self.time()), self.maybe("immediate"))
            tokens += self.maybe("safe", self.expression(1))
        return tokens

    def declarations(self, depth: int = 2) -> list[str]:
        tokens: list[str] = []
        for _ in range(self.random.randint(0, 5)):
            tokens += self.declaration(depth)
        return tokens

    def declaration(self, depth: int) -> list[str]:
        r = self.random
        kind = r.choice([["sync"], ["broadcast"], ["any"], ["buffer", "4"], ["overwrite", "(", "2", ")"], []])
        references = lambda: self.separated(",", self.reference, 1, 8)  # noqa: E731
        match r.randrange(7):
            case 0:
                size = r.choice([[], ["[", "8", "]"], ["[", "i", "<", "N", "]"]])
                return [self.name(), *size, ":", self.name(), *self.maybe("(", self.arguments(), ")")]
            case 1:
                return ["var", self.name(), ":", *self.type_name(), *self.maybe("=", self.expression(2))]
            case 2:
                return ["channel", self.name(), ":", *self.type_name(), *kind]
            case 3 if depth:
                return ["for", "i", "<", "N", "{", *self.declarations(depth - 1), "}"]
            case 4:
                return [*self.reference(), "->", self.name(), ":", *self.type_name(), *kind]
            case 5:
                typed = self.maybe(":", self.type_name())
                return flat(references(), "->", self.name(), typed, kind, "->", references())
            case _:
                return [*references(), "->", *r.choice([references(), ["_"]])]

    def composition(self, depth: int = 4) -> list[str]:
        if depth == 0 or self.random.random() < 0.4:
            return self.step(depth)
        operator = self.random.choice([";", ";", "||", "||>", "[]", "[]>"])
        return self.separated(operator, lambda: self.step(depth - 1), 2, 5)

    def step(self, depth: int) -> list[str]:
        r = self.random
        if depth == 0:
            return self.action(0)
        inner = depth - 1
        match r.randrange(9):
            case 0:
                return ["mu", *self.action(inner), *self.maybe("until", self.expression(1))]
            case 1:
                return ["while", *self.expression(1), "do", *self.step(inner)]
            case 2:
                return ["if", *self.expression(1), "then", *self.action(inner), *self.maybe("else", self.step(inner))]
            case 3:
                return [self.name(), ":", *self.step(inner)]
            case 4:
                return [r.choice(["seq", "par", "pripar", "alt", "prialt"]), "i", "<", "N", ":", *self.step(inner)]
            case 5:
                return [*self.guard(), "->", *self.step(inner)]
            case 6:
                return [*self.action(inner), "catch", "Timeout", "->", *self.action(inner)]
            case 7:
                return [*self.action(inner), "interrupt", *self.guard(), "->", *self.action(inner)]
            case _:
                return self.action(inner)

    def guard(self) -> list[str]:
        r = self.random
        event = r.choice(
            [
                self.reference(),
                [*self.reference(), "?", self.name()],
                [*self.reference(), "!", *self.expression(1)],
                ["after", *self.expression(1)],
                ["skip"],
            ]
        )
        return self.maybe("when", self.expression(1), "&") + event

    def action(self, depth: int) -> list[str]:
        r = self.random
        if depth and r.random() < 0.4:
            return ["(", *self.composition(depth - 1), ")"]
        return r.choice(
            [
                self.reference(),
                [*self.reference(), "?", *self.reference()],
                [*self.reference(), "!", *self.expression(2)],
                [*self.reference(), ":=", *self.expression(2)],
                ["skip"],
                ["stop"],
                ["wait", *self.expression(1)],
                ["reset", self.name()],
                ["raise", "Overheated"],
            ]
        )

    def equations(self) -> list[str]:
        tokens: list[str] = []
        for _ in range(self.random.randint(0, 5)):
            value = self.expression(3)
            tokens += self.random.choice(
                [
                    ["let", self.name(), "=", *value],
                    ["state", self.name(), ":", *self.type_name(), "=", *value],
                    [self.random.choice(["next", "der"]), self.name(), "=", *value],
                    [*self.reference(), "=", *value],
                    [self.name(), ":", "Pid", *self.maybe("(", self.arguments(), ")")],
                ]
            )
        return tokens

    def parameters(self) -> list[str]:
        def parameter() -> list[str]:
            return [self.name(), ":", *self.type_name(), *self.maybe("=", self.expression(1))]

        return self.maybe("(", self.separated(",", parameter) if self.random.random() < 0.8 else [], ")")

    def definition(self) -> list[str]:
        r = self.random
        body = self.maybe("python", '"plant.py:Joint"')
        match r.randrange(12):
            case 0:
                return r.choice([["import", '"laws.csp"'], ["import", "std", ".", "control"]])
            case 1:
                return ["const", self.name(), *self.maybe(":", self.type_name()), "=", *self.expression()]
            case 2:
                return ["type", self.name(), "=", *self.type_name()]
            case 3:
                return ["enum", self.name(), "{", *self.separated(",", lambda: [self.name()]), "}"]
            case 4:
                fields = self.separated(" ", lambda: [self.name(), ":", *self.type_name()], 0)
                return ["struct", self.name(), "{", *(token for token in fields if token != " "), "}"]
            case 5:
                return ["exception", self.name()]
            case 6:
                claim = r.choice(
                    [["deadlock", "free"], ["terminates"], ["refines", "Q"], ["refines", "Q", "in", "failures"]]
                )
                if claim[0] == "refines":
                    claim += self.maybe("hide", *self.separated(",", lambda: [self.name()]))
                return ["assert", self.name(), *claim]
            case 7:
                clauses = self.maybe("wcet", "5 us") + self.maybe("step", "1 ms") + self.maybe("method", "=", "tustin")
                head = ["submodel", self.name(), *self.parameters(), *body, *clauses]
                return [*head, "{", *self.ports(), *self.equations(), "}"]
            case 8:
                return ["driver", self.name(), *self.parameters(), *body, "{", *self.ports(), "}"]
            case 9:
                head = ["environment", self.name(), "for", self.name(), *self.maybe("(", self.arguments(), ")")]
                clauses = self.maybe("on", "miss", "count") + self.maybe("step", "1 ms")
                clauses += self.maybe("place", self.name(), ":", self.name(), *self.maybe(",", self.name()))
                return [*head, *clauses, "{", *self.declarations(), "}"]
            case _:
                head = ["process", self.name(), *self.parameters(), *body, *self.maybe("wcet", "1 ms")]
                communication = self.maybe("communication", "{", self.declarations(), "}")
                composition = self.maybe("composition", "{", self.composition(), "}")
                return [*head, "{", *self.ports(), *communication, *composition, "}"]


def flat(*parts: str | list[str]) -> list[str]:
    """Tokens and lists of tokens as one list."""
    return [token for part in parts for token in ([part] if isinstance(part, str) else part)]


def program(random: Random, definitions: int = 4) -> list[str]:
    """The tokens of a random program."""
    generator = Generator(random)
    return [token for _ in range(random.randint(0, definitions)) for token in generator.definition()]


def text_of(tokens: list[str]) -> str:
    """The program with a space between tokens; a unit follows its type directly."""
    return " ".join(tokens)


def sprinkled(tokens: list[str], random: Random) -> str:
    """The program with new lines, empty lines and comments anywhere between its tokens."""
    comments = ["// plain\n", "/// doc\n", "/* block */", "/* two\n   lines */", "//\n", "//// rule\n"]
    parts: list[str] = []
    for token in tokens:
        parts.append(token)
        if random.random() < 0.12:
            parts.append(random.choice([" ", "\n", "\n\n\n"]) + random.choice(comments))
        parts.append(random.choice([" ", " ", " ", " ", "\n", "\n\n", "  \t", "\r\n"]))
    return "".join(parts)
