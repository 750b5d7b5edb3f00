"""Communicating state machines: components, events and what is made of them."""
