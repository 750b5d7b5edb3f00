"""What is said where something cannot be proved, or is not what was asserted."""
