"""Runs of the program on its real runtime, led along a counterexample."""
