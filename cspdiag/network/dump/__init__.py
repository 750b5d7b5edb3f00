"""The network as text."""
