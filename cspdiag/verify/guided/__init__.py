"""Runs of the program on its real runtime, led to where a counterexample goes."""
