"""A whole program as one page: every definition with its diagrams, its text and its ports."""
