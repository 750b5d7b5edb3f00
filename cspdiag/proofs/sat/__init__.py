"""Tiers 1 and 2: proofs by SAT, refined by traps and linear invariants."""
