"""The common part of all targets."""
