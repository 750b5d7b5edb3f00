"""Text to syntax tree.

An LALR(1) automaton over the tables that Lark made of the grammar. It is a loop over explicit stacks, so Python's
recursion limit does not matter for the text; the tree it makes is at most ``DEEPEST`` levels deep, so that later passes
may recurse.
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
from cspdiag.syntax.parse.nesting import DEEPEST
from cspdiag.syntax.parse.tables import END

if TYPE_CHECKING:
    from cspdiag.syntax.unexpected.situation import Repair

_MOST_STATES = 25 * DEEPEST
"""More than the levels of a legal text can put on the stack."""


def parse(source: SourceFile, report: Report) -> ast.SourceTree:
    """The tree of a file.

    Where the text is broken, this is reported and reading continues at the next declaration or definition; the tree
    then lacks the broken ones and is not a program.
    """
    return Parser(source, report).run()


class Parser:
    """One run over one file.

    The stacks grow together, ``states`` being one longer: ``values`` has what was built, ``starts`` the offset at which
    it begins, ``depths`` its levels.
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
        self._taken_to = 0
        """Where the last token ended."""
        self._mended = (-1, 0)
        """Where the last mistake was, and how often it was repaired there."""
        self._last_reported = ("", "", 0)
        """Code, message and line of the last mistake: the same mistake all along a line is reported once."""
        builder = DefinitionBuilder(source, report, self.lexer.docs)
        self._builders: list[Callable[..., Any] | None] = [
            getattr(builder, rule.build) if rule.build else None for rule in self.automaton.tables.rules
        ]

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
                self._mend()
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
        elif kind in self.automaton.valued:
            value = Token(Span(self.source, lexer.start, lexer.end), lexer.text)
        self.values.append(value)
        self.starts.append(lexer.start)
        self.depths.append(0)
        self.states.append(state)
        self._taken_to = lexer.end
        lexer.advance(self.automaton.tables.actions[state])
        if lexer.kind in self.automaton.words_of_their_place and not self.automaton.accepts(self.states, lexer.kind):
            # The row of a state also has terminals that only follow elsewhere.
            lexer.kind = "NAME"
        if len(self.states) > _MOST_STATES:
            self._refuse_depth()

    def _reduce(self, number: int) -> None:
        table = self.automaton.tables
        origin, length, build, kept = table.rules[number]
        states = self.states
        if build is None:
            # The rule hands on its only child: nothing but the state changes.
            states[-1] = table.gotos[states[-2]][origin]
            return
        children: list[Any] = []
        start, depth = self.lexer.start, 0
        if length:
            children = self.values[-length:]
            start = self.starts[-length]
            depth = max(self.depths[-length:]) + self.automaton.levels[number]
            del self.values[-length:], self.starts[-length:], self.depths[-length:], states[-length:]
        builder = self._builders[number]
        if builder is None:
            value: Any = _grown(children, kept)
        else:
            span = Span(self.source, start, max(start, self._taken_to))
            if build in {"parenthesized", "group"} and (depth == 0 or children[1].parenthesized):
                depth += 1
            value = builder(span, *_arguments(children, kept))
        self.values.append(value)
        self.starts.append(start)
        self.depths.append(depth)
        states.append(table.gotos[states[-1]][origin])
        if depth > DEEPEST:
            self._refuse_depth()

    def _refuse_depth(self) -> None:
        lexer = self.lexer
        end = max(lexer.end, lexer.start + 1)
        self._skip_after(NestedTooDeeply(Span(self.source, lexer.start, end), DEEPEST))

    def _mend(self) -> None:
        """The present token cannot be taken: report why, and repair it."""
        # A text without mistakes does not pay for this.
        from cspdiag.syntax.unexpected.situation import Situation
        from cspdiag.syntax.unexpected.token import explain

        at, times = self._mended
        self._mended = (self.lexer.start, times + 1 if at == self.lexer.start else 1)
        if self._mended[1] > _MOST_STATES:
            # Every mending takes or leaves a token; should one ever do neither, reading goes on behind it.
            self.lexer.advance({})
        situation = Situation(self.source, self.automaton, self.states, self.starts, self.lexer)
        diagnostic, repair = explain(situation)
        if isinstance(diagnostic, KeywordAsName):
            self._tell_misuse(diagnostic)
            if repair is None:
                self._skip()
            else:
                self._apply(repair)
            return
        if repair is None:
            self._skip_after(diagnostic)
            return
        self._tell(diagnostic)
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
            case "insert":
                lexer.insert(repair.terminal)

    def _tell_misuse(self, diagnostic: KeywordAsName) -> None:
        """Once for each word: where it occurs again the mistake is the same."""
        if diagnostic.word not in self.lexer.misused:
            self._tell(diagnostic)
            self.lexer.misused.add(diagnostic.word)

    def _tell(self, diagnostic: Diagnostic) -> None:
        misused = self.lexer.misused
        if misused and (self.lexer.text in misused or self.lexer.before.text in misused):
            # A name that is a word of the language was taken for that word.
            return
        same = (diagnostic.code, diagnostic.message, diagnostic.span.line)
        if same != self._last_reported and not self.lexer.reported_on_line(diagnostic.span.start):
            self.report.add(diagnostic)
        self._last_reported = same

    def _skip_after(self, diagnostic: Diagnostic) -> None:
        """Report, then forget the declaration or definition being read and go to the next one."""
        self._tell(diagnostic)
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


def _arguments(children: list[Any], kept: tuple[int | None, ...]) -> list[Any]:
    """The children of a rule as a builder gets them: lists spliced in, None for what is absent."""
    arguments: list[Any] = []
    for position in kept:
        if position is None:
            arguments.append(None)
        elif position < 0:
            arguments += children[~position]
        else:
            arguments.append(children[position])
    return arguments


def _grown(children: list[Any], kept: tuple[int | None, ...]) -> list[Any]:
    """The list of a repetition: the list so far is the first child and grows in place, so that long ones stay cheap."""
    if kept[0] is None or kept[0] >= 0:
        return _arguments(children, kept)
    grown: list[Any] = children[~kept[0]]
    grown += _arguments(children, kept[1:])
    return grown
