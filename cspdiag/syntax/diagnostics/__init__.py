"""Diagnostics of the text."""
