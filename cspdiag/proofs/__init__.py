"""Proofs over transition systems: deadlock, knots, livelock, termination, refinement."""
