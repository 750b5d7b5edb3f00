"""Diagnostics of compositions: alternatives, parallels, sequences, and parts that are never reached."""
