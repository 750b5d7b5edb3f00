"""The standard format of programs."""
