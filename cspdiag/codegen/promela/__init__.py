"""Promela, the language of the model checker SPIN."""
