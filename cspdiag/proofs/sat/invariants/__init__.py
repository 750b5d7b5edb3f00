"""Proofs by linear invariants: weighted sums over the states of components that never change, or never increase."""
