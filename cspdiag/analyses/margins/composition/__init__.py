"""What the composition of a program does between its laws and the plant."""
