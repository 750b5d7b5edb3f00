"""Compositions as readable Python."""
