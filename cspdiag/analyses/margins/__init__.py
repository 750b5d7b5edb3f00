"""Stability and margins of the loops that a program closes through its plant, under its own timing."""
