"""Places, diagnostics and the ways to show them."""

from cspdiag.diagnostics.diagnostic import Diagnostic, Label, Severity
from cspdiag.diagnostics.report import Report
from cspdiag.diagnostics.span import SourceFile, Span

__all__ = ["Diagnostic", "Label", "Report", "Severity", "SourceFile", "Span"]
