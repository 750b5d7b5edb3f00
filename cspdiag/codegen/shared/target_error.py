"""The error of a target for a program that it cannot express."""

from cspdiag.base.errors import CspdiagError


class TargetError(CspdiagError, ValueError):
    """A program that is correct but cannot be made into the target's language; the message is for people,
    with places.
    """
