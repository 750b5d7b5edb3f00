"""Checks of what environments connect to: devices, their buttons, FMUs."""
