"""Assertions: what is asked of a process, and what the proofs answer."""
