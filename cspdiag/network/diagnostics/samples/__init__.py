"""Diagnostics of sample periods, of rates that do not fit, and of outputs that are released too late."""
