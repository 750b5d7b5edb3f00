"""Recurring work on one processor: response times, schedules and advice on priorities."""
