"""Recordings of a run: files, traces, plots, and the account for people."""
