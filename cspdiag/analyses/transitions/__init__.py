"""Networks as transition systems: what the proofs reason about."""
