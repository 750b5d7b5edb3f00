"""The tokens of a file in order, with the comments between them, as pieces of a layout.

The formatter changes only the space between tokens, so it can neither lose a comment nor change the meaning. The space
around a comment depends only on whether there is a line break before and after it, and the layout keeps these.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager

from cspdiag.base.record import record
from cspdiag.syntax.format.layout import Break, Mark, Padding, Piece, Separator
from cspdiag.syntax.parse.automaton import automaton

_DURATION = re.compile(r"([0-9.]+(?:[eE][+-]?[0-9]+)?)[ \t]*([A-Za-z]+)")


@record
class Comment:
    """A comment, with the numbers of line breaks before and after it."""

    text: str
    lines_before: int
    lines_after: int


class Writer:
    """Takes tokens from a text and collects the pieces of its layout."""

    def __init__(self, text: str) -> None:
        self.pieces: list[Piece] = []
        self._source = text
        scanner = automaton().scanner
        self._scan = scanner.token.match
        self._scan_unit = scanner.unit.match
        self._end = 0
        """The offset of the end of the last token that was taken."""
        self._separator: Separator = ""
        self._comments: list[Comment] = []
        self._next = ""
        self._next_start = 0
        self._next_end = 0
        self._at_block_start = False
        self._read()

    def _read(self) -> None:
        """Find the next token and the comments before it."""
        found: list[tuple[int, int]] = []
        at = self._end
        while True:
            match = self._scan(self._source, at)
            if match is None or match.lastgroup != "COMMENT":
                break
            found.append(match.span("COMMENT"))
            at = match.end()
        if match is None:
            self._next, self._next_start, self._next_end = "", len(self._source), len(self._source)
        else:
            assert match.lastgroup is not None
            self._next = match.group(match.lastgroup)
            self._next_start, self._next_end = match.span(match.lastgroup)
            if match.lastgroup == "DURATION":
                self._next = _DURATION.sub(r"\1 \2", self._next)
        self._comments = []
        before = self._end
        for position, (start, end) in enumerate(found):
            following = found[position + 1][0] if position + 1 < len(found) else self._next_start
            text = self._source[start:end].replace("\r\n", "\n").rstrip()
            self._comments.append(Comment(text, self._new_lines(before, start), self._new_lines(end, following)))
            before = end

    def _new_lines(self, start: int, end: int) -> int:
        return self._source.count("\n", start, end)

    @property
    def next(self) -> str:
        """The text of the next token; empty at the end."""
        return self._next

    def parentheses_before(self, offset: int) -> int:
        """The number of opening parentheses between the last token and an offset, without those in comments."""
        count, at = 0, self._next_start
        while at < offset and self._source[at] == "(":
            count += 1
            match = self._scan(self._source, at + 1)
            while match is not None and match.lastgroup == "COMMENT":
                match = self._scan(self._source, match.end())
            if match is None or match.lastgroup is None:
                break
            at = match.start(match.lastgroup)
        return count

    def new_line_before_next(self) -> bool:
        """Whether there is a line break between the last token and the next one."""
        if self._comments:
            return any(comment.lines_before or comment.lines_after for comment in self._comments)
        return self._new_lines(self._end, self._next_start) > 0

    def separate(self, separator: Separator) -> None:
        """Write a separator and the comments after it, before the group that follows."""
        self._separator = separator
        self.comments()
        self._put_separator()

    def keep_broken(self) -> bool:
        """Break the group that has just begun if its author broke it here; returns whether it was broken."""
        broken = self.new_line_before_next()
        if broken:
            self.pieces.append(Mark.BROKEN)
        return broken

    def take(self, separator: Separator = "") -> None:
        """Write the next token after ``separator``, or after the comments before it if these put it on a new line."""
        self._separator = separator
        self.comments()
        self._put_separator()
        self.pieces.append(self._next)
        self._end = self._next_end
        self._read()

    def take_unit(self) -> None:
        """Write the unit of a type directly after its name."""
        self._separator = ""
        self.comments()
        match = self._scan_unit(self._source, self._next_start)
        assert match is not None
        self.pieces.append(match.group())
        self._end = match.end()
        self._read()

    def _put_separator(self) -> None:
        if self._separator != "":
            self.pieces.append(self._separator)
        self._separator = ""

    def comments(self) -> None:
        """Write the comments before the next token, within an item."""
        for position, comment in enumerate(self._comments):
            if comment.lines_before and position == 0:
                self.pieces.append(Mark.NEW_LINE)
                self._separator = ""
            elif position == 0 and comment.lines_after:
                self.pieces.append(" ")
                self._separator = ""
            elif position == 0:
                self._put_separator()
                self._space()
            self.pieces.append(comment.text)
            self.pieces.append(Mark.NEW_LINE if comment.lines_after or self._next == "" else " ")
            self._separator = ""
        self._comments = []

    def _space(self) -> None:
        """A space before a comment, unless there is one."""
        last = self.pieces[-1] if self.pieces else " "
        if isinstance(last, str) and last.endswith((" ", "(", "[")):
            return
        if not isinstance(last, Break):
            self.pieces.append(" ")

    def begin_line(self, *, blank: bool | None = None) -> bool:
        """Begin the line of the next item, after the comments before it.

        ``blank`` forces (True) or suppresses (False) an empty line between the last item and the next; with None, the
        text decides. Returns whether the item directly follows the last one, without an empty line or a comment line.
        """
        directly = True
        decided = blank
        self._separator = ""
        if not self._comments:
            return self._line(self._new_lines(self._end, self._next_start), decided)
        for position, comment in enumerate(self._comments):
            glued = position > 0 and not comment.lines_before
            trailing = position == 0 and not comment.lines_before and (comment.lines_after or not self._next)
            if trailing:
                self.pieces.append(" ")
            elif not glued:
                self._line(comment.lines_before, decided)
                directly, decided = False, None
            self.pieces.append(comment.text)
            if not comment.lines_after and self._next:
                self.pieces.append(" ")
                if position == 0 and comment.lines_before == 0:
                    directly = False
        last = self._comments[-1]
        self._comments = []
        if last.lines_after and self._next:
            directly = self._line(last.lines_after, decided) and directly
        return directly

    def _line(self, new_lines: int, blank: bool | None) -> bool:
        """Write a new line; returns whether it has no empty line before it. A block never begins with an empty line."""
        is_blank = (new_lines > 1 if blank is None else blank) and not self._at_block_start
        self._at_block_start = False
        if self.pieces:
            self.pieces.append(Mark.BLANK_LINE if is_blank else Mark.NEW_LINE)
        return not is_blank

    @contextmanager
    def block(self) -> Iterator[None]:
        """A block, from its opening to its closing brace; its items begin their own lines."""
        self.take(" ")
        self._at_block_start = True
        self.pieces.append(Mark.INDENT)
        yield
        self._end_block()
        self.pieces += [Mark.DEDENT, Mark.NEW_LINE]
        self._at_block_start = False
        self.take()

    def _end_block(self) -> None:
        """Write the comments before a closing brace."""
        for comment in self._comments:
            if comment.lines_before:
                self._line(comment.lines_before, None)
            else:
                self.pieces.append(" ")
            self.pieces.append(comment.text)
        self._comments = []

    @contextmanager
    def group(self, before: Separator | None = None) -> Iterator[None]:
        """A group, which is kept on one line if it fits.

        With ``before``, the separator and the comments before the next token are written before the group, so they do
        not break it.
        """
        if before is not None:
            self.separate(before)
        self.pieces.append(Mark.OPEN)
        yield
        self.pieces.append(Mark.CLOSE)

    @contextmanager
    def indented(self) -> Iterator[None]:
        """A part whose broken lines are indented."""
        self.pieces.append(Mark.INDENT)
        yield
        self.pieces.append(Mark.DEDENT)

    def padding(self) -> Padding:
        """Padding, whose width is set later."""
        pad = Padding()
        self.pieces.append(pad)
        return pad
