"""Deadlocks: which processes wait for which, and why nobody continues."""
