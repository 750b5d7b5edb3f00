"""Silent steps: what a thread does by itself, without a choice and without another process seeing it."""
