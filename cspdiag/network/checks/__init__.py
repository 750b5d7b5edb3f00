"""What can be wrong with a program once its shapes are known."""
