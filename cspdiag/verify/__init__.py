"""Proofs and what makes them believed: counterexamples that the program itself runs, and changes that remove them."""
