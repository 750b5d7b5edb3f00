"""Three producers share one channel into the buffer: whoever is there first is served first."""
