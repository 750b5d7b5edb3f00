"""Submodels as flat, sorted and discretized systems of equations."""
