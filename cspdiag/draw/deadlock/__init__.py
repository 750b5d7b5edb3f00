"""Deadlocks as pictures: the ring of processes that wait for each other."""
