"""The one style of programs."""
