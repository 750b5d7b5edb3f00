"""Python that reads as if written by hand from the diagram."""
