"""The network representation."""
