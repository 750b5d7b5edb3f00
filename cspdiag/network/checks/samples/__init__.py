"""Samples that nobody takes: what a process does between two reads takes longer than the samples come."""
