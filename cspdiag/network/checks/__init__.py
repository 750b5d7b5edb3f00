"""Checks of programs whose shapes are known."""
