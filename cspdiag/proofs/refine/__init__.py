"""Refinement: whether a process does only what a specification allows."""
