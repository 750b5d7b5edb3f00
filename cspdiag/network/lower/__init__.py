"""From shapes to the network representation."""
