"""Tier 0: design rules that need no search."""
