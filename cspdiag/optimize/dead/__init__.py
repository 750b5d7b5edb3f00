"""Removes what has no effect."""
