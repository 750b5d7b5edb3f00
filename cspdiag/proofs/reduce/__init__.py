"""Smaller systems with the same answer: processes put together, hidden and minimized."""
