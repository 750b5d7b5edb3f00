"""Three producers share one channel into the buffer: first come, first served."""
