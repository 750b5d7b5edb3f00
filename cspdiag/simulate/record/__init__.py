"""Recordings of a run: files, traces, plots, and the printed summary."""
