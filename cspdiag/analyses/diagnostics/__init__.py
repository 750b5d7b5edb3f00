"""The diagnostics of the analyses."""
