"""Proofs by invariants: what hubs and counters keep in balance, found as sums that never change."""
