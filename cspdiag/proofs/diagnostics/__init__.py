"""The diagnostics of assertions that do not hold, or are not proved."""
