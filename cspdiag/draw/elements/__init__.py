"""The elements of diagrams, before anything has a place: the same for every layout and every output."""
