"""The package in C: which files there are, and what the whole takes."""
