"""Places, diagnostics and the ways to show them."""

from cspdiag.base.diagnostic import Diagnostic, Edit, Label, Severity
from cspdiag.base.report import Report
from cspdiag.base.span import SourceFile, Span

__all__ = ["Diagnostic", "Edit", "Label", "Report", "Severity", "SourceFile", "Span"]
