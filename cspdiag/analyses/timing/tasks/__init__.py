"""Response times, schedules and priority assignment for recurring work on one processor."""
