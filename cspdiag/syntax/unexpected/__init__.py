"""Explanations why a token is not allowed in its place."""
