"""Plots of recordings, with a separate place for every part and port."""
