"""Verifies the invariants of networks on which passes and targets rely."""
