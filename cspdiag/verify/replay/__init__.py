"""Replays of counterexamples: the program itself is stepped, and then led, along what a proof has found."""
