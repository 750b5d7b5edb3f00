"""Assertions: the questions about a process, and what the proofs answer."""
