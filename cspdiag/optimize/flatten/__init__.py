"""Processes that run in sequence become one."""
