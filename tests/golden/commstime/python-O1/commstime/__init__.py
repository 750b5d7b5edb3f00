"""The natural numbers, made by four processes in a circle."""
