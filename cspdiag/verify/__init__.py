"""Checks of proofs: replays of counterexamples by the program itself, and changes of the text that remove them."""
