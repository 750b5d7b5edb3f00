"""Diagnostics for people, editors and machines."""
