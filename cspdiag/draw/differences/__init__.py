"""What changed between two versions of a program, in terms of its diagrams."""
