"""Composition diagrams as pictures."""
