"""Elements that branches of a replicated parallel select by their number: ``worker[number]``."""

from __future__ import annotations

from cspdiag.base.record import record, replaced
from cspdiag.codegen.c.text.code import (
    PRODUCT,
    SUM,
    Atom,
    Code,
    Count,
    Element,
    Postfix,
    call,
    cast,
    infix,
    unsigned,
)
from cspdiag.codegen.c.text.types import duration, integer
from cspdiag.codegen.shared.document import Document
from cspdiag.codegen.shared.trees import nodes


@record
class Numbered(Code):
    """``step * number + first``, where ``number`` is the number of the branch; in loops a sum of several such products,
    of which some may count down. An index is unsigned; with ``type_name`` it is a value of that type, which may be a
    ``duration`` in nanoseconds.
    """

    products: tuple[tuple[str, int], ...]
    first: int = 0
    type_name: str | None = None
    is_duration: bool = False

    @property
    def precedence(self) -> int:
        """How tightly its operator binds."""
        return self._sum().precedence

    def as_index(self) -> Code:
        """The same without a cast."""
        return replaced(self, type_name=None)

    def _document(self) -> Document:
        return self._sum().document

    def _sum(self) -> Code:
        """What counts down is subtracted last: an unsigned sum is never less than 0 on the way."""
        up = [self._product(number, step) for number, step in self.products if step > 0]
        down = [self._product(number, -step) for number, step in self.products if step < 0]
        whole = up[0] if up else self._constant(self.first)
        for other in up[1:]:
            whole = infix("+", SUM, whole, other)
        if up and self.first != 0:
            whole = infix("+" if self.first > 0 else "-", SUM, whole, self._constant(abs(self.first)))
        for other in down:
            whole = infix("-", SUM, whole, other)
        return whole

    def _product(self, number: str, step: int) -> Code:
        counted = Atom(number) if self.type_name is None else cast(self.type_name, Atom(number))
        return counted if step == 1 else infix("*", PRODUCT, self._constant(step), counted)

    def _constant(self, value: int) -> Code:
        if self.type_name is None:
            return unsigned(value)
        return duration(value) if self.is_duration else integer(value)


@record
class Shifted(Code):
    """``first + by``, or ``first`` alone if ``by`` is 0; ``by`` may count."""

    first: Code
    by: Code

    @property
    def precedence(self) -> int:
        """How tightly its operator binds."""
        return self._sum().precedence

    def _document(self) -> Document:
        return self._sum().document

    def _sum(self) -> Code:
        return self.first if self.by == unsigned(0) else infix("+", SUM, self.first, self.by)


def mentions_number(item: object) -> bool:
    """Whether an expression or statements use the number of the branch."""
    return any(isinstance(node, Numbered) for node in nodes(item))


def at_first(member: Code) -> Code:
    """The member of the branch with number 0."""
    match member:
        case Element(operand=operand, index=Numbered(first=first)):
            return Element(at_first(operand), Count(first, "index"))
        case Element(operand=operand) | Postfix(operand=operand):
            return replaced(member, operand=at_first(operand))
        case _:  # A member that is not in an array.
            return member


def stride(struct: str, member: Code) -> Code | None:
    """The distance in bytes from the member of one branch to that of the next; None for a member that all share."""
    match member:
        case Element(operand=array, index=Numbered(products=((_, step),))):
            bytes_ = call("CSP_STRIDE", f"struct {struct}", array)
            return bytes_ if step == 1 else infix("*", PRODUCT, unsigned(step), bytes_)
        case Element(operand=operand) | Postfix(operand=operand):
            return stride(struct, operand)
        case _:  # A member that is not in an array.
            return None
