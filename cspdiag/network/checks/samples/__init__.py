"""Missed samples: a process that takes longer between two reads of an input than its samples are apart."""
