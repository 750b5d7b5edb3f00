"""Counterexamples for people and for machines: their steps, the processes that wait, and suggested changes."""
