"""Proofs in commands: time limits, a cache of results, and how answers are printed."""
