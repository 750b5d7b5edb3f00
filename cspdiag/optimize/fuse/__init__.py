"""Fuses a program whose schedule is known at compile time into one process."""
