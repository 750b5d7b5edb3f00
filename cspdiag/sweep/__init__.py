"""Sweeps: many runs of a program with different values, and a table of what was measured in each."""
