"""Recordings that are written while a run continues."""
