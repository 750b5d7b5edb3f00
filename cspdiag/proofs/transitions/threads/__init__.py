"""Threads of control: their states and edges, explored from compositions."""
