"""Points and rectangles. Lengths are in pixels of 1/96 inch, x to the right, y down."""

from __future__ import annotations

from cspdiag.base.record import record


@record
class Point:
    """A place in a drawing."""

    x: float
    y: float

    def moved(self, dx: float, dy: float) -> Point:
        """The point that lies ``dx`` to the right and ``dy`` below."""
        return Point(self.x + dx, self.y + dy)


@record
class Rectangle:
    """An upright rectangle by its upper left corner."""

    x: float
    y: float
    width: float
    height: float

    @property
    def right(self) -> float:
        """The x of the right side."""
        return self.x + self.width

    @property
    def bottom(self) -> float:
        """The y of the lower side."""
        return self.y + self.height

    @property
    def centre(self) -> Point:
        """The point in the middle."""
        return Point(self.x + self.width / 2, self.y + self.height / 2)

    def moved(self, dx: float, dy: float) -> Rectangle:
        """The same rectangle, ``dx`` to the right and ``dy`` below."""
        return Rectangle(self.x + dx, self.y + dy, self.width, self.height)

    def grown(self, by: float) -> Rectangle:
        """The rectangle with ``by`` more on every side; less if it is negative."""
        return Rectangle(self.x - by, self.y - by, self.width + 2 * by, self.height + 2 * by)

    def overlaps(self, other: Rectangle) -> bool:
        """Whether the two have inner points in common; rectangles that touch have none."""
        return self.x < other.right and other.x < self.right and self.y < other.bottom and other.y < self.bottom

    def contains(self, other: Rectangle) -> bool:
        """Whether ``other`` lies within, borders included."""
        return self.x <= other.x and self.y <= other.y and other.right <= self.right and other.bottom <= self.bottom


def around(rectangles: list[Rectangle]) -> Rectangle:
    """The smallest rectangle around the given ones. Raises ValueError if there are none."""
    left, top = min(each.x for each in rectangles), min(each.y for each in rectangles)
    right, bottom = max(each.right for each in rectangles), max(each.bottom for each in rectangles)
    return Rectangle(left, top, right - left, bottom - top)
