"""Communicating state machines: components, events, and what they are made from."""
