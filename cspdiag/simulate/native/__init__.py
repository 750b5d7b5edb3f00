"""Runs of programs that were compiled to C for this machine."""
