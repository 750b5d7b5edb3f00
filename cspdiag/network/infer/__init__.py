"""Infers what the text does not say: kinds of channels, sample periods, reading ends."""
