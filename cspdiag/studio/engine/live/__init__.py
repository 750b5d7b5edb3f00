"""Sessions: programs that run while they are watched, steered and stopped."""
