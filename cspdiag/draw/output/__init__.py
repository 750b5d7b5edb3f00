"""Drawings in the formats of files."""
