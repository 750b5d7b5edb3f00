"""Constant propagation, and what follows from constants."""
