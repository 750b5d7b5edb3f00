"""Python that reads as if it were written by hand from the diagram."""
