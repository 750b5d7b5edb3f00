"""Replays of counterexamples: the program itself is stepped, and then led, to where a proof has gone."""
