"""Programs → pictures: the elements of diagrams, their layout, and their look."""
