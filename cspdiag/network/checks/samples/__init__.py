"""Samples that are not taken: what a process does between two reads takes longer than the samples come."""
