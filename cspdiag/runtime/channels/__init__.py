"""Channels, and what processes see of them."""
