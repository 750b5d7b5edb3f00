"""Livelock, termination and runs without end."""
