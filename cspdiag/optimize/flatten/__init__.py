"""Inlines processes that run in sequence into the process around them."""
