"""Assertions as questions about processes, and the answers of the proofs."""
