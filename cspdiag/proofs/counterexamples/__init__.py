"""Refutations for people and for machines: steps, waiting, and ways to mend."""
