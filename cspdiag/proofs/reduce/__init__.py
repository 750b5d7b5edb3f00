"""Smaller systems with the same answer: processes are composed, their events hidden, and the results minimized."""
