"""Margins as text, JSON and pictures."""
