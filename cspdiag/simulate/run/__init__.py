"""Runs of a program in Python."""
