"""The current loop, which is the faster one, has the higher priority."""
