"""Text to syntax tree.

An LALR(1) automaton with the tables that Lark has made from the grammar. It is a loop over explicit stacks, so the text
may be nested deeper than Python's recursion limit; the tree is at most ``MAX_DEPTH`` levels deep, so later passes may
recurse.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from cspdiag.base import Diagnostic, Report, SourceFile
from cspdiag.base.span import Span
from cspdiag.syntax import ast
from cspdiag.syntax.build.definitions import DefinitionBuilder
from cspdiag.syntax.diagnostics.structure import KeywordAsName, NestedTooDeeply
from cspdiag.syntax.parse.automaton import automaton
from cspdiag.syntax.parse.lexer import Lexer, Token, is_doc
from cspdiag.syntax.parse.nesting import MAX_DEPTH
from cspdiag.syntax.parse.tables import END

if TYPE_CHECKING:
    from cspdiag.syntax.unexpected.situation import Repair

_ITSELF = (0,)
"""What is kept by rules whose builder gets their only child."""

_MAX_STATES = 25 * MAX_DEPTH
"""The largest stack, which is more than a text of legal depth needs."""


def parse(source: SourceFile, report: Report) -> ast.SourceTree:
    """The tree of a file.

    After a syntax error, reading continues at the next declaration or definition; the tree then lacks the erroneous
    ones and is not a complete program.
    """
    return Parser(source, report).run()


class Parser:
    """One run over one file.

    The stacks grow together, but ``states`` has one more element: ``values`` are the nodes and tokens, ``starts`` the
    offsets at which they begin, ``depths`` their levels of nesting.
    """

    def __init__(self, source: SourceFile, report: Report) -> None:
        self.source = source
        self.report = report
        self.automaton = automaton()
        self.lexer = Lexer(source, self.automaton.scanner, report)
        self.states = [self.automaton.tables.start]
        self.values: list[Any] = []
        self.starts: list[int] = []
        self.depths: list[int] = []
        self._end_of_last_token = 0
        """The offset of the end of the last token."""
        self._last_repair = (-1, 0)
        """The offset of the last mistake, and the number of repairs there."""
        self._last_reported = ("", "", 0)
        """Code, message and line of the last mistake: a mistake that is repeated on a line is reported once."""
        builder = DefinitionBuilder(source, report, self.lexer.docs)
        tables = self.automaton.tables
        self._builders: list[Callable[..., Any] | None] = [
            getattr(builder, rule.build) if rule.build else None for rule in tables.rules
        ]
        # Looked up here once, and not for each token and each rule.
        self._actions, self._gotos, self._rules, self._levels = (
            tables.actions,
            tables.gotos,
            tables.rules,
            self.automaton.levels,
        )
        self._valued, self._contextual = self.automaton.valued, self.automaton.contextual_keywords

    def run(self) -> ast.SourceTree:
        """Read the whole file."""
        actions = self.automaton.tables.actions
        lexer, states = self.lexer, self.states
        lexer.advance(actions[states[-1]])
        while True:
            action = actions[states[-1]].get(lexer.kind)
            if action is None:
                if lexer.kind == END and self.automaton.tables.symbols[states[-1]] == "start":
                    return self._tree(self.values[0])
                self._repair()
            elif action >= 0:
                self._shift(action)
            else:
                self._reduce(~action)

    def _shift(self, state: int) -> None:
        lexer = self.lexer
        kind = lexer.kind
        value: Any = None
        if kind == "NAME":
            value = ast.Identifier(span=Span(self.source, lexer.start, lexer.end), text=lexer.text)
        elif kind in self._valued:
            value = Token(Span(self.source, lexer.start, lexer.end), lexer.text)
        self.values.append(value)
        self.starts.append(lexer.start)
        self.depths.append(0)
        self.states.append(state)
        self._end_of_last_token = lexer.end
        lexer.advance(self._actions[state])
        if lexer.kind in self._contextual and not self.automaton.accepts(self.states, lexer.kind):
            # The row of a state also has terminals that are allowed only in other contexts.
            lexer.kind = "NAME"
        if len(self.states) > _MAX_STATES:
            self._refuse_depth()

    def _reduce(self, number: int) -> None:
        origin, length, build, kept = self._rules[number]
        states = self.states
        if build is None:
            # The rule passes its only child on, so only the state changes.
            states[-1] = self._gotos[states[-2]][origin]
            return
        children: list[Any] = []
        start, depth = self.lexer.start, 0
        if length == 1:
            children.append(self.values.pop())
            start = self.starts.pop()
            depth = self.depths.pop() + self._levels[number]
            states.pop()
        elif length:
            children = self.values[-length:]
            start = self.starts[-length]
            depth = max(self.depths[-length:]) + self._levels[number]
            del self.values[-length:], self.starts[-length:], self.depths[-length:], states[-length:]
        builder = self._builders[number]
        if builder is None:
            value: Any = _extended_list(children, kept)
        else:
            end = max(start, self._end_of_last_token)
            # A node that consists of another one is at the same place.
            span = _place_of(children[0], start, end) if length == 1 else None
            if span is None:
                span = Span(self.source, start, end)
            if build in {"parenthesized", "group"} and (depth == 0 or children[1].parenthesized):
                depth += 1
            value = builder(span, *(children if length == 1 and kept == _ITSELF else _arguments(children, kept)))
        self.values.append(value)
        self.starts.append(start)
        self.depths.append(depth)
        states.append(self._gotos[states[-1]][origin])
        if depth > MAX_DEPTH:
            self._refuse_depth()

    def _refuse_depth(self) -> None:
        lexer = self.lexer
        end = max(lexer.end, lexer.start + 1)
        self._skip_after(NestedTooDeeply(Span(self.source, lexer.start, end), MAX_DEPTH))

    def _repair(self) -> None:
        """Report why the present token is not allowed, and repair it."""
        # Imported only here, because a text without mistakes does not need it.
        from cspdiag.syntax.unexpected.situation import Situation
        from cspdiag.syntax.unexpected.token import explain

        at, times = self._last_repair
        self._last_repair = (self.lexer.start, times + 1 if at == self.lexer.start else 1)
        if self._last_repair[1] > _MAX_STATES:
            # Every repair consumes a token or leaves one; should a repair ever do neither, reading continues after it.
            self.lexer.advance({})
        situation = Situation(self.source, self.automaton, self.states, self.starts, self.lexer)
        diagnostic, repair = explain(situation)
        if isinstance(diagnostic, KeywordAsName):
            self._report_keyword(diagnostic)
            if repair is None:
                self._skip()
            else:
                self._apply(repair)
            return
        if repair is None:
            self._skip_after(diagnostic)
            return
        self._report_once(diagnostic)
        self._apply(repair)

    def _apply(self, repair: Repair) -> None:
        """Continue as if the present token were another one, were missing, or had another one before it."""
        lexer = self.lexer
        match repair.action:
            case "replace":
                lexer.replace(repair.terminal, repair.end or lexer.end)
            case "remove":
                lexer.replace(lexer.kind, repair.end or lexer.end)
                lexer.advance(self.automaton.tables.actions[self.states[-1]])
                return
            case "insert":
                lexer.insert(repair.terminal)
        # The tree has the operator that was meant.
        lexer.text = self.automaton.terminal_texts.get(repair.terminal, lexer.text)

    def _report_keyword(self, diagnostic: KeywordAsName) -> None:
        """Report a keyword that is used as a name, once for each word."""
        if diagnostic.word not in self.lexer.misused:
            self._report_once(diagnostic)
            self.lexer.misused.add(diagnostic.word)

    def _report_once(self, diagnostic: Diagnostic) -> None:
        misused = self.lexer.misused
        if misused and (self.lexer.text in misused or self.lexer.before.text in misused):
            # A name that is also a keyword was taken for the keyword.
            return
        same = (diagnostic.code, diagnostic.message, diagnostic.span.line)
        if same != self._last_reported and not self.lexer.reported_on_line(diagnostic.span.start):
            self.report.add(diagnostic)
        self._last_reported = same

    def _skip_after(self, diagnostic: Diagnostic) -> None:
        """Report a mistake, discard the present declaration or definition, and continue at the next one."""
        self._report_once(diagnostic)
        self._skip()

    def _skip(self) -> None:
        from cspdiag.syntax.parse import recovery

        height = recovery.skip(self.automaton, self.states, self.lexer)
        del self.states[height:], self.values[height - 1 :], self.starts[height - 1 :], self.depths[height - 1 :]

    def _tree(self, items: tuple[ast.Item, ...]) -> ast.SourceTree:
        source = self.source
        unused = {comment for comments in self.lexer.docs.values() for comment in comments}
        comments = tuple(comment for comment in self.lexer.comments if not is_doc(comment.text) or comment in unused)
        return ast.SourceTree(span=Span(source, 0, len(source.text)), source=source, items=items, comments=comments)


def _place_of(child: object, start: int, end: int) -> Span | None:
    """The span of a node, if it has just this range."""
    span = getattr(child, "span", None)
    return span if span is not None and span.start == start and span.end == end else None


def _arguments(children: list[Any], kept: tuple[int | None, ...]) -> list[Any]:
    """The children of a rule as arguments of a builder: with lists spliced in, and None for absent parts."""
    arguments: list[Any] = []
    for position in kept:
        if position is None:
            arguments.append(None)
        elif position < 0:
            arguments += children[~position]
        else:
            arguments.append(children[position])
    return arguments


def _extended_list(children: list[Any], kept: tuple[int | None, ...]) -> list[Any]:
    """The list of a repetition: the list so far, which is the first child, is extended in place, to be fast if long."""
    if kept[0] is None or kept[0] >= 0:
        return _arguments(children, kept)
    grown: list[Any] = children[~kept[0]]
    grown += _arguments(children, kept[1:])
    return grown
