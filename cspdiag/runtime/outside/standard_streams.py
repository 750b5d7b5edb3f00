"""The standard streams of a command; generated packages have the module of cspdiag itself here."""

from cspdiag.base.standard_streams import keep, standard_error, standard_output

__all__ = ["keep", "standard_error", "standard_output"]
