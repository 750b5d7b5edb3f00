"""Source places, diagnostics, and how they are shown."""

from cspdiag.base.diagnostic import Diagnostic, Edit, Label, Severity
from cspdiag.base.report import Report
from cspdiag.base.span import SourceFile, Span

__all__ = ["Diagnostic", "Edit", "Label", "Report", "Severity", "SourceFile", "Span"]
