"""Threads of control, followed from the composition to states and edges."""
