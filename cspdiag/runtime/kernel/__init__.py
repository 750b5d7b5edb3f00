"""Scheduling, time, and how runs end."""
