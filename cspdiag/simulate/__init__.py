"""Runs a compiled program against its environment: results, recordings, traces and plots."""
